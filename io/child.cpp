#include "io/child.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <exception>
#include <stdexcept>

namespace hourglass {
namespace {

// What the child sends last; what breaks off has neither.
constexpr char made = 'm', threw = 't';

void send(int pipe, const std::string& bytes) {
  for (std::size_t sent = 0; sent < bytes.size();) {
    const ssize_t n = ::write(pipe, bytes.data() + sent, bytes.size() - sent);
    if (n < 0 && errno != EINTR) ::_exit(1);
    sent += static_cast<std::size_t>(std::max<ssize_t>(n, 0));
  }
}

[[noreturn]] void be_child(const std::function<std::string()>& work, double seconds,
                           const std::array<int, 2>& pipe) {
  ::close(pipe[0]);
  for (const int signal : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGPROF, SIGPIPE}) std::signal(signal, SIG_DFL);
  const rlimit no_core{0, 0};
  ::setrlimit(RLIMIT_CORE, &no_core);
  const itimerval enough{{0, 0}, {static_cast<time_t>(seconds), 0}};
  ::setitimer(ITIMER_PROF, &enough, nullptr);
  if (const int nowhere = ::open("/dev/null", O_WRONLY); nowhere >= 0) ::dup2(nowhere, STDERR_FILENO);
  std::string answer;
  try {
    answer = work() + made;
  } catch (const std::exception& error) {
    answer = std::string(error.what()) + threw;
  }
  send(pipe[1], answer);
  ::_exit(0);
}

std::string all_of(int pipe) {
  std::string bytes;
  std::array<char, 1 << 16> block;
  for (;;) {
    const ssize_t n = ::read(pipe, block.data(), block.size());
    if (n == 0 || (n < 0 && errno != EINTR)) return bytes;
    bytes.append(block.data(), static_cast<std::size_t>(std::max<ssize_t>(n, 0)));
  }
}

}  // namespace

std::optional<std::string> from_child(const std::function<std::string()>& work, double seconds) {
  std::array<int, 2> pipe{};
  if (::pipe2(pipe.data(), O_CLOEXEC) != 0) return work();
  const pid_t child = ::fork();
  if (child == 0) be_child(work, seconds, pipe);
  ::close(pipe[1]);
  std::string answer = child > 0 ? all_of(pipe[0]) : "";
  ::close(pipe[0]);
  if (child < 0) return work();
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || answer.empty()) return std::nullopt;
  const char mark = answer.back();
  answer.pop_back();
  if (mark == threw) throw std::runtime_error(answer);
  return answer;
}

bool survives(const std::function<void()>& work) {
  try {
    return from_child([&] { return work(), std::string(); }).has_value();
  } catch (const std::runtime_error&) {
    return true;
  }
}

}  // namespace hourglass
