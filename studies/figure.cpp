#include "studies/figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

#include "io/render.hpp"
#include "studies/formula.hpp"
#include "studies/sweep_table.hpp"

namespace hourglass {
namespace {

namespace fs = std::filesystem;
using Kind = YamlNode::Kind;

const std::vector<std::string> own_keys{"figure",  "title",      "finding", "note",    "runs",
                                        "quality", "quantities", "tests",   "pictures"};

YamlNode* find_in(YamlNode& map, const std::string& key) {
  for (auto& [name, value] : map.keys)
    if (name == key) return &value;
  return nullptr;
}

/// The keys of `over` put into `map`, over its own.
void lay_over(YamlNode& map, const YamlNode& over) {
  for (const auto& [key, value] : over.keys)
    if (YamlNode* at = find_in(map, key))
      *at = value;
    else
      map.keys.emplace_back(key, value);
}

YamlNode empty_map() {
  YamlNode node;
  node.kind = Kind::map;
  return node;
}

class FigureReader {
 public:
  FigureReader(const fs::path& file, std::string quality)
      : strict_(file, "figure"), quality_(std::move(quality)) {}

  Figure read() {
    YamlNode root = strict_.root();
    std::vector<std::string> allowed = own_keys;
    allowed.insert(allowed.end(), study_keys.begin(), study_keys.end());
    strict_.known_keys(root, "", allowed);
    figure_.file = strict_.file();
    figure_.number = strict_.text(root, "", "figure");
    figure_.title = strict_.text(root, "", "title");
    figure_.finding = strict_.text(root, "", "finding");
    figure_.note = strict_.text(root, "", "note", "");
    read_study(root);
    for (const StudyAxis& axis : figure_.study.axes) axes_.push_back(axis.name);
    read_quantities(root);
    read_tests(root);
    read_pictures(root);
    strict_.refuse();
    return std::move(figure_);
  }

 private:
  void say(int line, const std::string& key, const std::string& what) { strict_.say(line, key, what); }

  // ---- runs --------------------------------------------------------------------------------------------------

  void read_study(YamlNode root) {
    figure_.folder = strict_.file().stem().string();
    const std::string shared = strict_.text(root, "", "runs", "");
    if (shared.empty()) {
      figure_.study = study_of(std::move(root), strict_);
      return;
    }
    for (const std::string& key : study_keys)
      if (const YamlNode* at = root.find(key))
        say(at->line, key, "stands beside runs, which brings the study of another figure. Remove one.");
    strict_.refuse();
    const fs::path file = strict_.file().parent_path() / shared;
    StrictReader other(file, "figure");
    figure_.study = study_of(other.root(), other);
    figure_.folder = file.stem().string();
  }

  Study study_of(YamlNode root, StrictReader& strict) {
    if (const YamlNode* qualities = root.find("quality")) {
      strict.known_keys(*qualities, "quality.", figure_qualities);
      for (const auto& [name, block] : qualities->keys)
        strict.known_keys(block, "quality." + name + '.', {"axes", "set", "values"});
      if (const YamlNode* block = qualities->find(quality_)) {
        const YamlNode over = *block;
        for (const auto& [key, values] : over.keys) {
          if (key == "values") {
            for (const auto& [axis, list] : values.keys) keep_cases(root, axis, list, strict);
            continue;
          }
          if (!root.find(key)) root.keys.emplace_back(key, empty_map());
          lay_over(*find_in(root, key), values);
        }
      }
    }
    strict.refuse();
    return study_in(root, strict);
  }

  /// Of an axis of cases only those that are listed.
  static void keep_cases(YamlNode& root, const std::string& axis, const YamlNode& list,
                         StrictReader& strict) {
    YamlNode* cases = find_in(root, "cases");
    YamlNode* all = cases ? find_in(*cases, axis) : nullptr;
    if (!all) return strict.say(list.line, "quality.values." + shown(axis), "is no axis of cases.");
    std::vector<std::pair<std::string, YamlNode>> kept;
    for (const YamlNode& name : list.items)
      if (const YamlNode* at = find_in(*all, name.text))
        kept.emplace_back(name.text, *at);
      else
        strict.say(name.line, "quality.values." + shown(axis),
                   fmt::format("'{}' is none of its cases.", shown(name.text)));
    all->keys = std::move(kept);
  }

  // ---- numbers of runs ---------------------------------------------------------------------------------------

  void read_quantities(const YamlNode& root) {
    const YamlNode* all = root.find("quantities");
    if (!all) return;
    strict_.once(*all, "quantities.");
    for (const auto& [name, node] : all->keys) {
      if (std::ranges::count(figures_of_merit, name) > 0)
        say(node.line, "quantities." + name, "is a figure of merit already. Rename it.");
      figure_.quantities[name] = quantity_of(node, "quantities." + shown(name) + '.', strict_);
    }
  }

  std::string quantity(const YamlNode& map, const std::string& below, const std::string& key,
                       const std::optional<std::string>& other = {}) {
    std::vector<std::string> words = figures_of_merit;
    for (const auto& [name, at] : figure_.quantities) words.push_back(name);
    if (other && !map.find(key)) return *other;
    return strict_.word(map, below, key, words);
  }

  std::optional<std::size_t> axis(const YamlNode& map, const std::string& below, const std::string& key) {
    if (!map.find(key)) return std::nullopt;
    const std::string name = strict_.word(map, below, key, axes_);
    const auto at = std::ranges::find(axes_, name);
    return at == axes_.end() ? std::nullopt : std::optional<std::size_t>(at - axes_.begin());
  }

  Choice choice(const YamlNode& map, const std::string& below) {
    Choice out;
    const YamlNode* where = map.find("where");
    if (!where) return out;
    for (const auto& [name, node] : where->keys) {
      const std::string key = below + "where." + shown(name);
      const auto at = std::ranges::find(axes_, name);
      if (at == axes_.end()) {
        say(node.line, key, fmt::format("is no axis (there are: {}).", fmt::join(axes_, ", ")));
        continue;
      }
      Choice::Of of{static_cast<std::size_t>(at - axes_.begin()), {}, false};
      const std::vector<YamlNode> items = node.kind == Kind::list ? node.items : std::vector<YamlNode>{node};
      for (const YamlNode& item : items) {
        std::string value = item.text;
        if (value.starts_with('!')) of.others = true, value.erase(0, 1);
        const auto& values = figure_.study.axes[of.axis].values;
        const auto same = std::ranges::find_if(values, [&](const std::string& v) { return equal(v, value); });
        if (same != values.end())
          of.values.push_back(*same);
        else if (!of.others)
          say(item.line, key,
              fmt::format("'{}' is no value of it (there are: {}).", shown(value), fmt::join(values, ", ")));
      }
      out.of.push_back(std::move(of));
    }
    return out;
  }
  static bool equal(const std::string& a, const std::string& b) {
    const auto x = number_in(a), y = number_in(b);
    return x && y ? *x == *y : a == b;
  }

  Pick pick(const YamlNode& map, const std::string& below) {
    return {quantity(map, below, "of", "discharge_rate"), choice(map, below), axis(map, below, "along"),
            strict_.word(map, below, "take", take_words, "only")};
  }

  // ---- tests -------------------------------------------------------------------------------------------------

  void read_tests(const YamlNode& root) {
    const YamlNode* tests = root.find("tests");
    if (!tests || tests->kind != Kind::list || tests->items.empty())
      return say(tests ? tests->line : 0, "tests", "is missing or empty (expected a list of tests).");
    for (std::size_t k = 0; k < tests->items.size(); ++k)
      read_test(tests->items[k], fmt::format("tests.{}.", k));
  }

  void read_test(const YamlNode& node, const std::string& below) {
    static const std::vector<std::string> bounds{"at_least", "at_most", "between"};
    FindingTest test;
    const bool several = node.find("pick");
    std::vector<std::string> allowed{"what", "differs", "only"};
    allowed.insert(allowed.end(), bounds.begin(), bounds.end());
    const std::vector<std::string> rest = several ? std::vector<std::string>{"value", "pick"}
                                                  : std::vector<std::string>{"of", "where", "along", "take"};
    allowed.insert(allowed.end(), rest.begin(), rest.end());
    strict_.known_keys(node, below, allowed);
    test.what = strict_.text(node, below, "what");
    test.only = node.find("only") ? strict_.word(node, below, "only", figure_qualities) : "";
    // What is of another quality may name values that the axes of this one have not.
    if (!test.only.empty() && test.only != quality_) return;
    if (several) {
      test.value = strict_.text(node, below, "value");
      std::map<std::string, double> ones;
      for (const auto& [name, map] : node.find("pick")->keys) {
        const std::string place = below + "pick." + shown(name) + '.';
        strict_.known_keys(map, place, {"of", "where", "along", "take"});
        test.picks[name] = pick(map, place);
        ones[name] = 1;
      }
      try {
        for (const std::string& name : names_in(test.value)) value_of(name, ones);
      } catch (const FormulaError& error) {
        say(node.line, below + "value", error.what());
      }
    } else {
      test.value = "x";
      test.picks["x"] = pick(node, below);
    }
    test.bounds = bounds_of(node, below);
    if (const YamlNode* differs = node.find("differs")) {
      std::vector<std::string> keys = bounds;
      keys.push_back("why");
      strict_.known_keys(*differs, below + "differs.", keys);
      test.differs = bounds_of(*differs, below + "differs.");
      test.why = strict_.text(*differs, below + "differs.", "why");
      if (std::max(test.bounds.least, test.differs->least) < std::min(test.bounds.most, test.differs->most))
        say(differs->line, below + "differs", "overlaps with what the thesis shows. Part them.");
    }
    figure_.tests.push_back(std::move(test));
  }

  Bounds bounds_of(const YamlNode& node, const std::string& below) {
    Bounds out;
    if (node.find("at_least")) out.least = strict_.number(node, below, "at_least");
    if (node.find("at_most")) out.most = strict_.number(node, below, "at_most");
    if (const auto both = strict_.interval(node, below, "between")) out = {(*both)[0], (*both)[1]};
    if (!std::isfinite(out.least) && !std::isfinite(out.most))
      say(node.line, below + "at_least", "is missing (expected at_least, at_most or between).");
    return out;
  }

  // ---- pictures ----------------------------------------------------------------------------------------------

  void read_pictures(const YamlNode& root) {
    const YamlNode* pictures = root.find("pictures");
    if (!pictures || pictures->kind != Kind::list || pictures->items.empty())
      return say(pictures ? pictures->line : 0, "pictures",
                 "is missing or empty (expected a list of pictures).");
    std::set<std::string> names;
    for (std::size_t k = 0; k < pictures->items.size(); ++k) {
      const std::string below = fmt::format("pictures.{}.", k);
      if (const YamlNode* only = pictures->items[k].find("only"); only && only->text != quality_) continue;
      FigurePicture picture = read_picture(pictures->items[k], below);
      if (!names.insert(picture.name).second)
        say(pictures->items[k].line, below + "name", "is the name of another picture. Rename it.");
      figure_.pictures.push_back(std::move(picture));
    }
  }

  FigurePicture read_picture(const YamlNode& node, const std::string& below) {
    const std::vector<std::string> words(picture_kinds.begin(), picture_kinds.end());
    FigurePicture p;
    const std::string kind = strict_.word(node, below, "kind", words);
    const auto at = std::ranges::find(words, kind) - words.begin();
    if (at == std::ssize(words)) return p;
    p.kind = static_cast<PictureKind>(at);
    static const std::map<PictureKind, std::vector<std::string>> keys{
        {PictureKind::panels, {"field", "times", "overlays", "columns", "range"}},
        {PictureKind::curves, {"y", "along", "over_first", "log_x", "log_y", "x_title", "y_title", "line"}},
        {PictureKind::series, {"y", "x", "x_title", "y_title"}},
        {PictureKind::profiles, {"heights", "times"}},
        {PictureKind::beverloo, {"y"}},
        {PictureKind::radial, {"y", "q_range"}}};
    std::vector<std::string> allowed = keys.at(p.kind);
    for (const char* key : {"kind", "name", "caption", "where", "only"}) allowed.push_back(key);
    strict_.known_keys(node, below, allowed);
    p.name = strict_.text(node, below, "name");
    p.caption = strict_.text(node, below, "caption");
    p.where = choice(node, below);
    if (node.find("times")) p.times = strict_.numbers(node, below, "times");
    if (p.kind == PictureKind::panels) read_panels(node, below, p);
    if (p.kind == PictureKind::profiles) p.heights = strict_.numbers(node, below, "heights");
    if (p.kind == PictureKind::series) read_series(node, below, p);
    if (p.kind == PictureKind::radial) {
      p.y = strict_.word(node, below, "y", {"error", "q"});
      p.q_range = strict_.interval(node, below, "q_range").value_or(p.q_range);
      return p;
    }
    if (p.kind == PictureKind::curves || p.kind == PictureKind::beverloo)
      p.y = quantity(node, below, "y", "discharge_rate");
    p.y_title =
        strict_.text(node, below, "y_title", p.y.empty() && !p.formulas.empty() ? p.formulas[0].second : p.y);
    p.x_title = strict_.text(node, below, "x_title", "");
    if (p.kind != PictureKind::curves) return p;
    p.along = axis(node, below, "along");
    if (!p.along) say(node.line, below + "along", "is missing (expected an axis).");
    const auto yes = [&](const char* key) {
      return strict_.word(node, below, key, {"true", "false"}, "false") == "true";
    };
    p.over_first = yes("over_first"), p.log_x = yes("log_x"), p.log_y = yes("log_y");
    if (const YamlNode* line = node.find("line")) {
      strict_.known_keys(*line, below + "line.", {"of", "where", "title", "times"});
      p.line = pick(*line, below + "line.");
      p.line_title = strict_.text(*line, below + "line.", "title");
      p.line_times = strict_.number(*line, below + "line.", "times", 1.0);
    }
    return p;
  }

  void read_series(const YamlNode& node, const std::string& below, FigurePicture& p) {
    p.x = strict_.word(node, below, "x", {"t", "drained"}, "t");
    const YamlNode* y = node.find("y");
    if (y && y->kind == Kind::map) {
      for (const auto& [name, formula] : y->keys) p.formulas.emplace_back(name, formula.text);
    } else {
      p.formulas.emplace_back("", strict_.text(node, below, "y"));
    }
    for (const auto& [name, formula] : p.formulas) try {
        names_in(formula);
      } catch (const FormulaError& error) {
        say(node.line, below + "y", error.what());
      }
  }

  void read_panels(const YamlNode& node, const std::string& below, FigurePicture& p) {
    std::vector<std::string> fields;
    for (const FieldInfo& info : known_fields()) fields.push_back(info.name);
    p.field = strict_.word(node, below, "field", fields);
    p.columns = static_cast<int>(strict_.number(node, below, "columns", 3.0));
    if (p.columns < 1 || p.columns > 6) say(node.line, below + "columns", "is out of range (1 to 6).");
    p.range = strict_.interval(node, below, "range");
    if (const YamlNode* overlays = node.find("overlays"))
      for (const YamlNode& item : overlays->items) {
        const auto at = std::ranges::find(overlay_names, item.text);
        if (at == overlay_names.end())
          say(item.line, below + "overlays",
              fmt::format("'{}' is none (allowed: {}).", shown(item.text), fmt::join(overlay_names, ", ")));
        else
          p.overlays.push_back(static_cast<Overlay>(at - overlay_names.begin()));
      }
  }

  StrictReader strict_;
  std::string quality_;
  Figure figure_;
  std::vector<std::string> axes_;
};

}  // namespace

std::string Bounds::text() const {
  if (!std::isfinite(most)) return fmt::format(">= {:.6g}", least);
  if (!std::isfinite(least)) return fmt::format("<= {:.6g}", most);
  return fmt::format("{:.6g} to {:.6g}", least, most);
}

Figure read_figure(const fs::path& file, const std::string& quality) {
  return FigureReader(file, quality).read();
}

std::vector<const FigureRun*> FigureTable::chosen(const Choice& choice) const {
  std::vector<const FigureRun*> out;
  for (const FigureRun& run : runs_)
    if (std::ranges::all_of(choice.of, [&](const Choice::Of& of) {
          return (std::ranges::count(of.values, run.run.values[of.axis]) > 0) != of.others;
        }))
      out.push_back(&run);
  return out;
}

double FigureTable::number(const FigureRun& run, const std::string& of) const {
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  if (!run.ended_well) return unknown;
  if (const auto at = run.merits.find(of); at != run.merits.end()) return at->second;
  const auto quantity = figure_.quantities.find(of);
  if (quantity == figure_.quantities.end()) return unknown;
  const auto [known, is_new] = known_.emplace(std::pair(run.run.name, of), unknown);
  if (is_new) known->second = quantity->second(run.data);
  return known->second;
}

double FigureTable::place(const FigureRun& run, std::size_t axis) const {
  const std::string& value = run.run.values[axis];
  if (const auto number = number_in(value)) return *number;
  const auto& values = figure_.study.axes[axis].values;
  return static_cast<double>(std::ranges::find(values, value) - values.begin() + 1);
}

double FigureTable::number(const Pick& pick) const {
  std::vector<TablePoint> points;
  for (const FigureRun* run : chosen(pick.where))
    points.push_back({pick.along ? place(*run, *pick.along) : static_cast<double>(points.size()),
                      number(*run, pick.of), &run->run.scene});
  std::ranges::stable_sort(points, {}, &TablePoint::x);
  return take(pick.take, points);
}

Finding judge(const FindingTest& test, const FigureTable& table) {
  std::map<std::string, double> numbers;
  Finding out{&test, std::numeric_limits<double>::quiet_NaN(), Verdict::fail};
  for (const auto& [name, pick] : test.picks) {
    numbers[name] = table.number(pick);
    if (!std::isfinite(numbers[name])) return out;
  }
  try {
    out.measured = value_of(test.value, numbers);
  } catch (const FormulaError&) {  // not finite
    return out;
  }
  out.verdict = test.bounds.hold(out.measured)                     ? Verdict::pass
                : test.differs && test.differs->hold(out.measured) ? Verdict::differs
                                                                   : Verdict::fail;
  return out;
}

}  // namespace hourglass
