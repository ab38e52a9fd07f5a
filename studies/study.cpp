#include "studies/study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>

#include "io/scene_yaml.hpp"
#include "io/yaml_tree.hpp"
#include "studies/formula.hpp"
#include "studies/strict_reader.hpp"
#include "studies/sweep_table.hpp"

namespace hourglass {
namespace {

using Kind = YamlNode::Kind;

constexpr int most_values = 1000, most_runs = 10000, most_messages = 20;

/// A value as it stands in a file, on one line: what --set takes.
std::string flow_text(const YamlNode& node) {
  std::vector<std::string> parts;
  switch (node.kind) {
    case Kind::null:
      return "null";
    case Kind::scalar: {
      if (!node.quoted) return node.text;
      std::string text = "'";
      for (const char c : node.text) text += c == '\'' ? "''" : std::string(1, c);
      return text + "'";
    }
    case Kind::list:
      for (const YamlNode& item : node.items) parts.push_back(flow_text(item));
      return fmt::format("[{}]", fmt::join(parts, ", "));
    case Kind::map:
      for (const auto& [key, value] : node.keys) parts.push_back(key + ": " + flow_text(value));
      return fmt::format("{{{}}}", fmt::join(parts, ", "));
  }
  return {};
}

class StudyReader {
 public:
  explicit StudyReader(StrictReader& strict) : strict_(strict) { study_.file = strict.file(); }

  Study read(const YamlNode& root, bool part) {
    root_ = root;
    read_names();
    if (!part || root_.find("axes")) read_axes();
    read_cases();
    read_pairs();
    read_settings();
    read_keep();
    strict_.refuse();
    return std::move(study_);
  }

 private:
  void say(int line, const std::string& key, const std::string& what) { strict_.say(line, key, what); }
  void known_keys(const YamlNode& map, const std::string& below, const std::vector<std::string>& allowed) {
    strict_.known_keys(map, below, allowed);
  }
  void once(const YamlNode& map, const std::string& below) { strict_.once(map, below); }

  void read_names() {
    study_.name = study_.file.stem().string();
    if (const YamlNode* node = root_.find("name")) {
      study_.name = node->text;
      if (node->kind != Kind::scalar || study_.name.empty() || study_.name.size() > 100 ||
          study_.name.find('/') != std::string::npos || study_.name[0] == '.')
        say(node->line, "name",
            fmt::format("found {} (expected 1 to 100 characters without / and no dot first).",
                        what_is(*node)));
    }
    const YamlNode* node = root_.find("scene");
    if (!node || node->kind != Kind::scalar || node->text.empty()) {
      say(node ? node->line : 0, "scene",
          fmt::format("{} (expected the scene file, relative to the study). Add scene: silo.yaml.",
                      node ? "found " + what_is(*node) : "is missing"));
      return;
    }
    study_.scene = study_.file.parent_path() / node->text;
  }

  void read_axes() {
    const YamlNode* axes = root_.find("axes");
    if (!axes && root_.find("cases")) return;
    if (!axes || axes->kind != Kind::map || axes->keys.empty()) {
      say(axes ? axes->line : 0, "axes",
          fmt::format("{} (expected a map of one axis or more). Add axes: {{gap: [0, 2, 5]}}.",
                      axes ? "found " + what_is(*axes) : "is missing"));
      return;
    }
    once(*axes, "axes.");
    for (const auto& [name, node] : axes->keys) {
      const std::string key = "axes." + shown(name);
      check_name(name, node.line, key);
      study_.axes.push_back({name, values_of(node, key), node.line, {}});
    }
  }
  void check_name(const std::string& name, int line, const std::string& key) {
    if (!is_formula_name(name) || name.size() > 100)
      say(line, key,
          "is no name for an axis (letters, digits, _ and dots, a letter first; not min, max, abs, sqrt). "
          "Rename it.");
    if (std::ranges::count(figures_of_merit, name) > 0 || name == "run" || name == "status" ||
        name == "reason")
      say(line, key, "is a column that results.csv has already. Rename it.");
    if (std::ranges::count(study_.axes, name, &StudyAxis::name) > 0)
      say(line, key, "is an axis already. Rename it.");
  }

  void read_cases() {
    const YamlNode* cases = root_.find("cases");
    if (!cases) return;
    if (cases->kind != Kind::map || cases->keys.empty()) {
      say(cases->line, "cases",
          fmt::format("found {} (expected a map of axes: {{insert: {{none: {{}}, square: {{<scene path>: "
                      "<value>}}}}}}).",
                      what_is(*cases)));
      return;
    }
    once(*cases, "cases.");
    for (const auto& [name, node] : cases->keys) {
      const std::string key = "cases." + shown(name);
      check_name(name, node.line, key);
      StudyAxis axis{name, {}, node.line, {}};
      if (node.kind != Kind::map || node.keys.empty() || node.keys.size() > most_values)
        say(node.line, key,
            fmt::format("found {} (expected 1 to {} named cases).", what_is(node), most_values));
      once(node, key + ".");
      for (const auto& [value, sets] : node.keys) {
        axis.values.push_back(value);
        std::vector<StudySetting>& settings = axis.cases.emplace_back();
        if (sets.kind != Kind::map && sets.kind != Kind::null)
          say(sets.line, key + '.' + shown(value),
              fmt::format("found {} (expected a map of scene paths to values, or {{}}).", what_is(sets)));
        once(sets, key + '.' + shown(value) + '.');
        for (const auto& [path, at] : sets.keys) settings.push_back({path, flow_text(at), false, at.line});
      }
      study_.axes.push_back(std::move(axis));
    }
  }

  std::vector<std::string> values_of(const YamlNode& node, const std::string& key) {
    if (node.kind == Kind::map) return range_of(node, key);
    std::vector<std::string> values;
    if (node.kind != Kind::list || node.items.empty() || node.items.size() > most_values) {
      say(node.line, key,
          fmt::format(
              "found {} (expected a list of 1 to {} values, or {{from: 1, to: 100, count: 5, scale: log}}).",
              node.kind == Kind::list ? fmt::format("a list of {}", node.items.size()) : what_is(node),
              most_values));
      return values;
    }
    for (const YamlNode& item : node.items) {
      if (item.kind != Kind::scalar || item.text.empty() || item.text.size() > 200)
        say(item.line, key, fmt::format("found {} (expected a number or a word).", what_is(item)));
      if (std::ranges::count(values, item.text) > 0)
        say(item.line, key, fmt::format("has {} twice. Keep one.", shown(item.text)));
      values.push_back(item.text);
    }
    return values;
  }

  std::vector<std::string> range_of(const YamlNode& node, const std::string& key) {
    const std::size_t before = strict_.said();
    known_keys(node, key + ".", {"from", "to", "count", "scale"});
    const auto number = [&](const char* name) {
      const YamlNode* at = node.find(name);
      const auto value = at && at->kind == Kind::scalar ? number_in(at->text) : std::nullopt;
      if (!value)
        say(at ? at->line : node.line, key + '.' + name,
            fmt::format("{} (expected a number).", at ? "found " + what_is(*at) : "is missing"));
      return value.value_or(0);
    };
    const double from = number("from"), to = number("to"), count = number("count");
    const YamlNode* scale = node.find("scale");
    const bool log = scale && scale->text == "log";
    if (scale && !log && scale->text != "linear")
      say(scale->line, key + ".scale", fmt::format("found {} (allowed: linear, log).", what_is(*scale)));
    if (strict_.said() > before) return {};
    if (count < 2 || count > most_values || count != std::floor(count))
      say(node.line, key + ".count",
          fmt::format("{} is out of range (a whole number from 2 to {}).", count, most_values));
    if (from == to) say(node.line, key + ".to", "is where the range begins. Give another.");
    if (log && (from <= 0 || to <= 0))
      say(node.line, key + ".from",
          "a log range needs from and to above 0. Mend them, or take scale: linear.");
    if (strict_.said() > before) return {};
    std::vector<std::string> values;
    const int n = static_cast<int>(count);
    for (int k = 0; k < n; ++k) {
      const double share = static_cast<double>(k) / (n - 1);
      const double value = k == 0       ? from
                           : k == n - 1 ? to
                           : log        ? from * std::pow(to / from, share)
                                        : from + (to - from) * share;
      values.push_back(fmt::format("{}", value));
    }
    return values;
  }

  void read_pairs() {
    std::vector<int> group_of(study_.axes.size(), -1);  // in `paired`
    if (const YamlNode* paired = root_.find("paired")) {
      if (paired->kind != Kind::list)
        say(paired->line, "paired",
            fmt::format("found {} (expected lists of axes, [[mu_s, delta_mu]]).", what_is(*paired)));
      for (std::size_t g = 0; g < paired->items.size(); ++g)
        read_pair(paired->items[g], static_cast<int>(g), group_of);
    }
    for (int a = 0; a < std::ssize(study_.axes); ++a) {
      std::vector<int> group;
      for (int b = 0; b < std::ssize(study_.axes); ++b)
        if (b == a || (group_of[a] >= 0 && group_of[b] == group_of[a])) group.push_back(b);
      if (group[0] == a) study_.groups.push_back(group);
    }
    double runs = 1;
    for (const std::vector<int>& group : study_.groups)
      runs *= static_cast<double>(study_.axes[group[0]].values.size());
    if (runs > most_runs)
      say(study_.axes.front().line, "axes",
          fmt::format("are {} runs (at most {}). Shorten them, or pair axes that advance together (paired).",
                      runs, most_runs));
  }
  void read_pair(const YamlNode& list, int number, std::vector<int>& group_of) {
    const std::string key = fmt::format("paired.{}", number);
    if (list.kind != Kind::list || list.items.size() < 2) {
      say(list.line, key, fmt::format("found {} (expected a list of two axes or more).", what_is(list)));
      return;
    }
    std::vector<std::string> names;
    for (const StudyAxis& axis : study_.axes) names.push_back(axis.name);
    int first = -1;
    for (const YamlNode& item : list.items) {
      const int a = static_cast<int>(std::ranges::find(names, item.text) - names.begin());
      if (a == std::ssize(names)) {
        const std::string meant = nearest(item.text, names);
        say(item.line, key,
            fmt::format("'{}' is no axis (there are: {}).{}", shown(item.text), fmt::join(names, ", "),
                        meant.empty() ? "" : fmt::format(" Did you mean '{}'?", meant)));
        continue;
      }
      if (group_of[a] >= 0)
        say(item.line, key, fmt::format("{} is paired already. Keep it once.", item.text));
      group_of[a] = number;
      if (first < 0) first = a;
      const std::size_t n = study_.axes[a].values.size(), wanted = study_.axes[first].values.size();
      if (n != wanted)
        say(item.line, key,
            fmt::format("{} has {} values and {} has {}. Axes that advance together need as many.",
                        names[first], wanted, names[a], n));
    }
  }

  void read_settings() {
    std::set<std::string> used;
    const YamlNode* set = root_.find("set");
    if (set && set->kind != Kind::map) {
      say(set->line, "set",
          fmt::format("found {} (expected a map of scene paths to formulas).", what_is(*set)));
      return;
    }
    if (set) {
      once(*set, "set.");
      for (const auto& [path, node] : set->keys) {
        if (node.kind != Kind::scalar)
          say(node.line, "set." + shown(path),
              fmt::format("found {} (expected a formula of the axes, or a value in quotes).", what_is(node)));
        else
          read_setting(path, node, used);
      }
    }
    for (const StudyAxis& axis : study_.axes) {
      const bool is_path = axis.name.find('.') != std::string::npos;
      if (!axis.cases.empty()) continue;
      if (is_path && !(set && set->find(axis.name))) {
        study_.settings.push_back({axis.name, axis.name, true, axis.line});
      } else if (used.count(axis.name) == 0) {
        say(axis.line, "axes." + axis.name,
            fmt::format("changes nothing: no formula of set names it, and it is no dotted path of the scene. "
                        "Add set: {{<scene path>: {}}}.",
                        axis.name));
      }
    }
  }
  void read_setting(const std::string& path, const YamlNode& node, std::set<std::string>& used) {
    study_.settings.push_back({path, node.text, !node.quoted, node.line});
    if (node.quoted) return;
    try {
      std::map<std::string, double> numbers;
      const std::set<std::string> names = names_in(node.text);
      used.insert(names.begin(), names.end());
      if (names.size() == 1 && *names.begin() == node.text && axis_named(node.text))
        return;  // a word may pass
      for (const StudyAxis& axis : study_.axes)
        if (std::ranges::all_of(axis.values, [](const std::string& v) { return number_in(v).has_value(); }))
          numbers[axis.name] = 1;
      for (const std::string& name : names) value_of(name, numbers);
    } catch (const FormulaError& error) {
      say(node.line, "set." + shown(path), error.what() + std::string(" A text goes in quotes."));
    }
  }
  bool axis_named(const std::string& name) const {
    return std::ranges::any_of(study_.axes, [&](const StudyAxis& axis) { return axis.name == name; });
  }

  void read_keep() {
    const YamlNode* keep = root_.find("keep");
    if (!keep) return;
    const std::vector<YamlNode> words = keep->kind == Kind::list ? keep->items : std::vector<YamlNode>{*keep};
    for (const YamlNode& word : words) {
      if (word.text == "fields")
        study_.keep_fields = true;
      else if (word.text == "snapshots")
        study_.keep_snapshots = true;
      else
        say(word.line, "keep",
            fmt::format("found {} (allowed: fields, snapshots, or a list of both).", what_is(word)));
    }
  }

  StrictReader& strict_;
  Study study_;
  YamlNode root_;
};

/// What a setting gives a run, as for --set.
std::string value_for(const Study& study, const StudySetting& setting, const StudyRun& run) {
  if (!setting.is_formula) return setting.text;
  std::map<std::string, double> numbers;
  for (std::size_t a = 0; a < study.axes.size(); ++a) {
    if (setting.text == study.axes[a].name) return run.values[a];
    if (const auto value = number_in(run.values[a])) numbers[study.axes[a].name] = *value;
  }
  return fmt::format("{}", value_of(setting.text, numbers));
}

/// Words said of many runs: once, with the first of them.
class Messages {
 public:
  void add(const std::string& text, const std::string& run) {
    const auto at = std::ranges::find(all_, text, &One::text);
    if (at == all_.end())
      all_.push_back({text, run, 1});
    else
      ++at->runs;
  }
  std::vector<std::string> lines(std::size_t of_runs) const {
    std::vector<std::string> out;
    for (const One& one : all_) {
      if (out.size() == most_messages) {
        out.push_back(fmt::format("... and {} more", all_.size() - most_messages));
        break;
      }
      out.push_back(one.runs == of_runs ? one.text + " (all runs)"
                    : one.runs == 1
                        ? fmt::format("{} (run {})", one.text, one.run)
                        : fmt::format("{} (run {}, and {} more)", one.text, one.run, one.runs - 1));
    }
    return out;
  }
  bool empty() const { return all_.empty(); }

 private:
  struct One {
    std::string text, run;
    std::size_t runs;
  };
  std::vector<One> all_;
};

}  // namespace

std::string StudyRun::text(const Study& study) const {
  std::vector<std::string> parts;
  for (std::size_t a = 0; a < values.size(); ++a)
    parts.push_back(study.axes[a].name + '=' + shown(values[a]));
  return fmt::format("{}", fmt::join(parts, " "));
}

Study read_study(const std::filesystem::path& file) {
  StrictReader strict(file, "study");
  const YamlNode root = strict.root();
  strict.known_keys(root, "", study_keys);
  return StudyReader(strict).read(root, false);
}

Study study_in(const YamlNode& root, StrictReader& strict) { return StudyReader(strict).read(root, true); }

std::vector<StudyRun> runs_of(const Study& study, std::vector<std::string>& warnings) {
  std::vector<StudyRun> runs;
  std::size_t count = 1;
  for (const std::vector<int>& group : study.groups) count *= study.axes[group[0]].values.size();
  Messages wrong, doubtful;
  for (std::size_t r = 0; r < count; ++r) {
    StudyRun run{fmt::format("{:04}", r + 1), std::vector<std::string>(study.axes.size()), {}};
    std::size_t rest = r;
    for (std::size_t g = study.groups.size(); g-- > 0;) {
      const std::size_t n = study.axes[study.groups[g][0]].values.size();
      for (const int a : study.groups[g]) run.values[a] = study.axes[a].values[rest % n];
      rest /= n;
    }
    const std::string who = fmt::format("{}: {}", run.name, run.text(study));
    std::vector<std::string> sets;
    std::map<std::string, std::string> places;  // of diagnostics, by what load_scene() calls them
    const auto place_of = [&](const StudySetting& setting) {
      return fmt::format("{}:{} {}", study.file.string(), setting.line, shown(setting.path));
    };
    std::vector<StudySetting> settings = study.settings;
    for (std::size_t a = 0; a < study.axes.size(); ++a)
      if (const StudyAxis& axis = study.axes[a]; !axis.cases.empty()) {
        const auto& chosen = axis.cases[std::ranges::find(axis.values, run.values[a]) - axis.values.begin()];
        settings.insert(settings.end(), chosen.begin(), chosen.end());
      }
    for (const StudySetting& setting : settings) {
      try {
        sets.push_back(setting.path + '=' + value_for(study, setting, run));
        places["--set " + shown(sets.back())] = place_of(setting);
      } catch (const FormulaError& error) {
        wrong.add(fmt::format("{}: {}", place_of(setting), error.what()), who);
      }
    }
    if (!study.keep_fields) sets.push_back("output.fields_every=0");
    if (!study.keep_snapshots) sets.push_back("output.snapshots_every=0");
    const Loaded loaded = load_scene(study.scene, sets);
    for (const Diagnostic& d : loaded.diagnostics) {
      Diagnostic told = d;
      if (const auto at = places.find(d.place); at != places.end()) {
        told.place = at->second;
        if (at->second.ends_with(' ' + d.path)) told.path.clear();
      }
      (d.fatal ? wrong : doubtful).add(told.text(), who);
    }
    run.scene = loaded.scene;
    runs.push_back(std::move(run));
  }
  if (!wrong.empty()) throw std::invalid_argument(fmt::format("{}", fmt::join(wrong.lines(count), "\n")));
  warnings = doubtful.lines(count);
  return runs;
}

}  // namespace hourglass
