// The alarm that a child sets which reads a file first (io/survives.hpp): a million damaged files, one in twenty of which
// sends the HDF5 library round in circles, have no ten seconds each. Here it is 30 ms of processor time.
#include <sys/time.h>
#include <unistd.h>

extern "C" unsigned alarm(unsigned) noexcept {
  const itimerval while_working{{0, 0}, {0, 30000}};
  ::setitimer(ITIMER_PROF, &while_working, nullptr);
  return 0;
}
