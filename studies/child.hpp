#pragma once
// Another program, run beside this one.
#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace hourglass {

/// Dies with the process that began it, even if that is killed.
class Child {
 public:
  /// What it prints to standard error goes to `log`, the rest nowhere. Throws std::runtime_error if there can be no
  /// process; a program that cannot be started ends with status 127.
  Child(const std::vector<std::string>& command, const std::filesystem::path& log);

  /// How it ended; nothing while it runs.
  std::optional<int> wait_status();
  void terminate();  ///< asks it to end

 private:
  pid_t pid_;
};

/// What a program said and how it ended.
struct ProgramOutput {
  int wait_status = 0;
  std::string out, err;
};
/// Runs a program of the PATH to its end; one that cannot be started ends with status 127. Throws std::runtime_error if there
/// can be no process.
ProgramOutput output_of(const std::vector<std::string>& command);

/// "exit status 1", "killed by signal 11 (Segmentation fault)".
std::string text_of_wait_status(int status);

}  // namespace hourglass
