// The processor time that a child has which works on a file (io/child.hpp): a million damaged files, one in twenty of
// which sends the HDF5 library round in circles, have no ten seconds each. Here it is 50 ms, or 2 s under sanitizers.
#include <sys/syscall.h>
#include <sys/time.h>
#include <unistd.h>

#if defined(__has_feature)
#define HAS_FEATURE(name) __has_feature(name)
#else
#define HAS_FEATURE(name) 0
#endif

extern "C" int setitimer(__itimer_which_t which, const itimerval* wanted, itimerval* before) noexcept {
#if defined(__SANITIZE_ADDRESS__) || HAS_FEATURE(address_sanitizer)
  const itimerval short_time{{0, 0}, {2, 0}};
#else
  const itimerval short_time{{0, 0}, {0, 50000}};
#endif
  return static_cast<int>(
      ::syscall(SYS_setitimer, which, which == ITIMER_PROF ? &short_time : wanted, before));
}
