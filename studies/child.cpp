#include "studies/child.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <stdexcept>

namespace hourglass {
namespace {

/// As exec() wants them; they live as long as the command.
std::vector<char*> words_of(const std::vector<std::string>& command) {
  std::vector<char*> words;
  for (const std::string& word : command) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  return words;
}

[[noreturn]] void no_process() {
  throw std::runtime_error(fmt::format("no further process: {}", std::strerror(errno)));
}

}  // namespace

Child::Child(const std::vector<std::string>& command, const std::filesystem::path& log) {
  std::vector<char*> words = words_of(command);
  const pid_t parent = ::getpid();
  pid_ = ::fork();
  if (pid_ < 0) no_process();
  if (pid_ > 0) return;
  // Between fork and exec only what is safe in a signal handler.
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(127);  // it died before that
  const int nothing = ::open("/dev/null", O_RDWR),
            errors = ::open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
  ::dup2(nothing, STDIN_FILENO);
  ::dup2(nothing, STDOUT_FILENO);
  ::dup2(errors >= 0 ? errors : nothing, STDERR_FILENO);
  ::execv(words[0], words.data());
  ::_exit(127);
}

std::optional<int> Child::wait_status() {
  int status = 0;
  if (::waitpid(pid_, &status, WNOHANG) != pid_) return std::nullopt;
  return status;
}

void Child::terminate() { ::kill(pid_, SIGTERM); }

ProgramOutput output_of(const std::vector<std::string>& command) {
  std::vector<char*> words = words_of(command);
  std::array<std::array<int, 2>, 2> pipes{};
  for (auto& ends : pipes)
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) no_process();
  const pid_t pid = ::fork();
  if (pid < 0) no_process();
  if (pid == 0) {
    ::dup2(::open("/dev/null", O_RDONLY), STDIN_FILENO);
    ::dup2(pipes[0][1], STDOUT_FILENO);
    ::dup2(pipes[1][1], STDERR_FILENO);
    ::execvp(words[0], words.data());
    ::_exit(127);
  }
  ProgramOutput output;
  std::array<pollfd, 2> ends{};
  for (int k = 0; k < 2; ++k) {
    ::close(pipes[k][1]);
    ends[k] = {pipes[k][0], POLLIN, 0};
  }
  while (ends[0].fd >= 0 || ends[1].fd >= 0) {
    if (::poll(ends.data(), 2, -1) < 0 && errno != EINTR) break;
    for (int k = 0; k < 2; ++k) {
      if (ends[k].fd < 0 || ends[k].revents == 0) continue;
      std::array<char, 4096> some{};
      const ssize_t n = ::read(ends[k].fd, some.data(), some.size());
      if (n > 0) (k == 0 ? output.out : output.err).append(some.data(), static_cast<std::size_t>(n));
      if (n > 0 || (n < 0 && errno == EINTR)) continue;
      ::close(ends[k].fd);
      ends[k].fd = -1;
    }
  }
  while (::waitpid(pid, &output.wait_status, 0) < 0 && errno == EINTR) {
  }
  return output;
}

std::string text_of_wait_status(int status) {
  if (WIFSIGNALED(status))
    return fmt::format("killed by signal {} ({})", WTERMSIG(status), strsignal(WTERMSIG(status)));
  return fmt::format("exit status {}", WEXITSTATUS(status));
}

}  // namespace hourglass
