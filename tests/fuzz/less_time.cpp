// The processor time that a child has which works on a file (io/child.hpp): a million damaged files, one in twenty of
// which sends the HDF5 library round in circles, have no ten seconds each. Here it is 30 ms.
#include <sys/syscall.h>
#include <sys/time.h>
#include <unistd.h>

extern "C" int setitimer(__itimer_which_t which, const itimerval* wanted, itimerval* before) noexcept {
  const itimerval short_time{{0, 0}, {0, 30000}};
  return static_cast<int>(
      ::syscall(SYS_setitimer, which, which == ITIMER_PROF ? &short_time : wanted, before));
}
