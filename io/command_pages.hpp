#pragma once
// The man page and the completions of shells, made of the table that reads the command line, so that they cannot say
// anything else than --help does.
#include <string>

namespace CLI {
class App;
}

namespace hourglass {

/// In the man macros of groff, section 1.
std::string man_page(const CLI::App& app, const std::string& version);
/// To be sourced by bash, or loaded by bash-completion. Completes commands, options, words and files.
std::string bash_completion(const CLI::App& app);
/// A function file for zsh's completion system, _hourglass.
std::string zsh_completion(const CLI::App& app);

}  // namespace hourglass
