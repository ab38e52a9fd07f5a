#include "io/command_pages.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <vector>

namespace hourglass {
namespace {

struct OptionText {
  std::string name;                ///< "--out", or the name of a positional: "scene"
  std::string value;               ///< "DIR"; empty for a flag
  std::vector<std::string> words;  ///< the only values that are allowed; empty: any
  std::string description;
  bool positional = false;
};

struct CommandText {
  std::string name, description;
  std::vector<OptionText> options;
};

/// CLI11 shows the words of an IsMember in braces behind the name of the type.
void split_words(OptionText& option) {
  const std::size_t open = option.value.find('{');
  if (open == std::string::npos) return;
  const std::string list = option.value.substr(open + 1, option.value.find('}') - open - 1);
  for (const std::string& word : CLI::detail::split(list, ',')) option.words.push_back(word);
  option.value.erase(option.value.find_last_not_of(": ", open - 1) + 1);
}

CommandText read(const CLI::App& command) {
  CommandText text{command.get_name(), command.get_description(), {}};
  for (const CLI::Option* o : command.get_options()) {
    OptionText option{o->get_name(),
                      o->get_items_expected_max() > 0 ? o->get_type_name() : "",
                      {},
                      o->get_description(),
                      o->get_positional()};
    split_words(option);
    option.value.erase(std::min(option.value.find(':'), option.value.size()));  // what a validator says
    option.value.erase(std::min(option.value.find(" in ["), option.value.size()));
    text.options.push_back(std::move(option));
  }
  return text;
}

std::vector<CommandText> commands_of(const CLI::App& app) {
  std::vector<CommandText> commands;
  for (const CLI::App* command :
       app.get_subcommands([](const CLI::App* c) { return !c->get_group().empty(); }))
    commands.push_back(read(*command));
  return commands;
}

/// With what groff or a shell would take for a command of its own made harmless.
std::string escaped(const std::string& text, const std::string& special) {
  std::string out;
  for (const char c : text) {
    if (special.find(c) != std::string::npos) out += '\\';
    out += c;
  }
  return out;
}
std::string troff(const std::string& text) {
  const std::string out = escaped(text, "-\\");
  return !out.empty() && (out[0] == '.' || out[0] == '\'') ? "\\&" + out : out;
}

/// Whether the value is a file or a folder, which the shell completes by itself.
bool is_file(const OptionText& o) {
  for (const char* name : {"SCENE.yaml", "STUDY.yaml", "FILE", "DIR", "RUN", "STUDY"}) {
    if (o.value.find(name) != std::string::npos) return true;
  }
  return false;
}

}  // namespace

std::string man_page(const CLI::App& app, const std::string& version) {
  std::string page = fmt::format(
      ".TH HOURGLASS 1 \"\" \"hourglass {}\" \"User Commands\"\n"
      ".SH NAME\nhourglass \\- granular silo flow\n"
      ".SH SYNOPSIS\n.B hourglass\n.I COMMAND\n.RI [ arguments ]\n"
      ".SH DESCRIPTION\n{}\nScenes and studies are YAML files; "
      "/usr/share/hourglass/configs has examples.\n.SH COMMANDS\n",
      troff(version), troff(app.get_description()));
  for (const CommandText& command : commands_of(app)) {
    page += fmt::format(".SS \"hourglass {}", command.name);
    for (const OptionText& o : command.options) {
      if (o.positional) page += " " + (o.value.empty() ? o.name : o.value);
    }
    page += fmt::format("\"\n{}\n", troff(command.description));
    for (const OptionText& o : command.options) {
      page += fmt::format(".TP\n.B {}", troff(o.positional ? o.value : o.name));
      if (!o.positional && !o.value.empty()) page += fmt::format(" \\fI{}\\fR", troff(o.value));
      page += fmt::format("\n{}", troff(o.description));
      if (!o.words.empty()) page += troff(fmt::format(" ({})", fmt::join(o.words, ", ")));
      page += '\n';
    }
  }
  return page +
         ".SH EXIT STATUS\n.TP\n.B 0\nfinished as asked\n.TP\n.B 1\nthe run failed (diverged, disk full, "
         "...); the last "
         "good state is on disk\n.TP\n.B 2\nthe scene or the command line is wrong; nothing was "
         "written\n.TP\n.B 130, "
         "143\nstopped by SIGINT or SIGTERM\n"
         ".SH FILES\n.TP\n.I runs/<name>/\nwhat a run leaves behind\n.TP\n.I "
         "/usr/share/doc/hourglass/\nevery key of a "
         "scene, every file of a run, the equations\n";
}

std::string bash_completion(const CLI::App& app) {
  std::string cases, names;
  for (const CommandText& command : commands_of(app)) {
    names += " " + command.name;
    std::string options, values;
    for (const OptionText& o : command.options) {
      if (o.positional) continue;
      options += " " + o.name;
      if (!o.words.empty())
        values += fmt::format("        {}) words=\"{}\" ;;\n", o.name, fmt::join(o.words, " "));
      else if (!o.value.empty() && !is_file(o))
        values += fmt::format("        {}) return ;;\n", o.name);
    }
    cases += fmt::format("    {})\n      options=\"{}\"\n", command.name, options.substr(1));
    if (!values.empty()) cases += fmt::format("      case $before in\n{}      esac\n", values);
    cases += "      ;;\n";
  }
  return fmt::format(
      "# bash completion of hourglass\n"
      "_hourglass() {{\n"
      "  local now=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD - 1]}} options= words=\n"
      "  if [ \"$COMP_CWORD\" = 1 ]; then\n"
      "    COMPREPLY=($(compgen -W \"{} --help --version\" -- \"$now\"))\n"
      "    return\n"
      "  fi\n"
      "  case ${{COMP_WORDS[1]}} in\n"
      "{}"
      "  esac\n"
      "  if [ -n \"$words\" ]; then\n"
      "    COMPREPLY=($(compgen -W \"$words\" -- \"$now\"))\n"
      "  elif [ \"${{now:0:1}}\" = - ]; then\n"
      "    COMPREPLY=($(compgen -W \"$options\" -- \"$now\"))\n"
      "  else\n"
      "    COMPREPLY=($(compgen -f -- \"$now\"))\n"
      "  fi\n"
      "}}\n"
      "complete -o filenames -F _hourglass hourglass\n",
      names.substr(1), cases);
}

std::string zsh_completion(const CLI::App& app) {
  // Within _arguments, what follows a colon or a bracket would be syntax; within quotes of zsh, a quote.
  const auto quoted = [](const std::string& text) {
    std::string out;
    for (const char c : escaped(text, "[]:")) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return out;
  };
  std::string list, cases;
  for (const CommandText& command : commands_of(app)) {
    list += fmt::format("    '{}:{}'\n", command.name, quoted(command.description));
    cases += fmt::format("    {})\n      _arguments", command.name);
    for (const OptionText& o : command.options) {
      const std::string action =
          o.words.empty() ? (is_file(o) ? "_files" : " ") : fmt::format("({})", fmt::join(o.words, " "));
      const std::string value =
          o.value.empty() && o.words.empty()
              ? ""
              : fmt::format(":{}:{}", quoted(o.value.empty() ? o.name : o.value), action);
      cases += o.positional ? fmt::format(" \\\n        '1{}'", value)
                            : fmt::format(" \\\n        '*{}[{}]{}'", o.name, quoted(o.description), value);
    }
    cases += "\n      ;;\n";
  }
  return fmt::format(
      "#compdef hourglass\n"
      "# zsh completion of hourglass\n"
      "_hourglass() {{\n"
      "  local -a commands\n"
      "  commands=(\n{}  )\n"
      "  if (( CURRENT == 2 )); then\n"
      "    _describe command commands\n"
      "    return\n"
      "  fi\n"
      "  local command=$words[2]\n"
      "  shift words\n"
      "  (( CURRENT-- ))\n"
      "  case $command in\n{}  esac\n"
      "}}\n"
      "_hourglass \"$@\"\n",
      list, cases);
}

}  // namespace hourglass
