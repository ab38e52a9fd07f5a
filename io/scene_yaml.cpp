#include "io/scene_yaml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "io/scene_reader.hpp"
#include "io/scene_writer.hpp"
#include "io/start.hpp"
#include "io/yaml_tree.hpp"
#include "solver/scene_keys.hpp"
#include "solver/solids.hpp"
#include "solver/steady_flow.hpp"

namespace hourglass {

namespace {

using Kind = YamlNode::Kind;

/// Defaults are multiples of the grain's scales; those that the file does not give are brought to them.
void apply_scales(const Scene& s, const YamlNode& root, SceneReader& reader) {
  const Scales all = scales(s);
  std::vector<std::string> without_scale;
  for (const SceneReader::Unscaled& one : reader.unscaled) {
    const double scale = all.*one.scale;
    if (std::isfinite(scale) && scale > 0)
      one.value *= scale;
    else if (s.gravity[0] == 0 && s.gravity[1] == 0)
      without_scale.push_back(one.path);
  }
  const YamlNode* gravity = root.find("gravity");
  if (!without_scale.empty())
    reader.findings.push_back(
        {gravity ? gravity : &root, "gravity",
         fmt::format("is zero, so these have no default: {}. Give them.", fmt::join(without_scale, ", "))});
}

/// The stored run that the scene begins with: whether it can, and the time of its frame.
void find_start(const YamlNode& root, Scene& scene, std::vector<SceneReader::Finding>& findings) {
  if (!scene.start) return;
  const YamlNode& node = *root.find("start");
  try {
    scene.start->time = start_time(scene);
  } catch (const std::exception& error) {
    findings.push_back({&node, "start", fmt::format("{}.", error.what())});
  }
}

/// A grid for a file that names none.
void choose_cells(const YamlNode& root, Loaded& loaded, std::vector<SceneReader::Finding>& findings) {
  Scene& s = loaded.scene;
  const YamlNode* grid = root.find("grid");
  const YamlNode* cells = grid ? grid->find("cells_x") : nullptr;
  if (cells && cells->text != "auto") return;
  s.cells_x = Scene{}.cells_x;  // where the domain is wrong already
  const int across = s.accuracy.cells_across_orifice;
  if (!(s.width > 0 && s.height > 0 && across > 0)) return;
  const DefaultCells chosen = default_cells(s);
  if (chosen.cells_x == 0) {
    findings.push_back(
        {grid ? grid : &root, "grid.cells_x",
         "is missing, and near what accuracy asks for no number of cells gives a whole height and "
         "coarsens. Give it, or choose a height with a simple ratio to the width."});
    return;
  }
  s.cells_x = chosen.cells_x;
  std::string why = "across a domain without orifices";
  if (chosen.narrowest > 0)
    why = fmt::format("{:.3g} of them across the narrowest orifice", chosen.narrowest / s.width * s.cells_x);
  if (chosen.fewer)
    why += fmt::format(" (fewer than the {} asked for: at most {} are chosen without being named)", across,
                       most_default_cells);
  loaded.notes.push_back(fmt::format("grid.cells_x: {} chosen by accuracy, {}", s.cells_x, why));
}

void mark_origin(YamlNode& node, int override_index) {
  node.line = 0;
  node.override_index = override_index;
  for (YamlNode& item : node.items) mark_origin(item, override_index);
  for (auto& [key, value] : node.keys) mark_origin(value, override_index);
}

/// `accuracy: fast` is short for `accuracy: {preset: fast}`; spelt out it can be added to.
void spell_out_accuracy(YamlNode& root) {
  for (auto& [key, node] : root.keys) {
    if (key != "accuracy" || node.kind != Kind::scalar) continue;
    YamlNode map;
    map.kind = Kind::map;
    map.line = node.line;
    map.override_index = node.override_index;
    map.keys.emplace_back("preset", std::move(node));
    node = std::move(map);
  }
}

/// The node at a dotted path, or the nearest one above it that is there.
const YamlNode& nearest_node(const YamlNode& root, const std::string& path) {
  const YamlNode* at = &root;
  for (const std::string& step : split_path(path)) {
    const YamlNode* next = at->find(step);
    if (!next) break;
    at = next;
  }
  return *at;
}

}  // namespace

std::string Diagnostic::text() const {
  return fmt::format("{}{}{}: {}{}", place, path.empty() ? "" : " ", path, fatal ? "" : "warning: ", message);
}

bool Loaded::ok() const {
  return std::none_of(diagnostics.begin(), diagnostics.end(), [](const Diagnostic& d) { return d.fatal; });
}

Loaded load_scene(const std::filesystem::path& path, const std::vector<std::string>& overrides) {
  Loaded loaded;
  std::vector<Diagnostic>& diagnostics = loaded.diagnostics;
  const std::string file = path.string();
  const auto at_line = [&](int line) { return line > 0 ? fmt::format("{}:{}", file, line) : file; };

  YamlNode root;
  try {
    root = parse_yaml(read_yaml_text(path, "scene"));
    if (root.kind != Kind::map)
      throw YamlError(root.line,
                      fmt::format("found {} (expected a scene: a map of keys such as domain, grid, "
                                  "materials).",
                                  what_is(root)));
  } catch (const YamlError& error) {
    diagnostics.push_back({at_line(error.line), "", error.what()});
    return loaded;
  }
  std::vector<Diagnostic> lost_overrides;
  for (std::size_t k = 0; k < overrides.size(); ++k) {
    const std::size_t equals = overrides[k].find('=');
    const std::string key = overrides[k].substr(0, equals);
    try {
      if (equals == std::string::npos) throw YamlError(0, "expected path=value, e.g. grid.cells_x=256.");
      YamlNode value = parse_yaml(overrides[k].substr(equals + 1));
      mark_origin(value, static_cast<int>(k));
      if (key.starts_with("accuracy.")) spell_out_accuracy(root);
      assign(root, key, std::move(value));
    } catch (const YamlError& error) {
      const std::string named = equals == std::string::npos ? "" : shown(key);
      lost_overrides.push_back({"--set " + shown(overrides[k]), named, error.what()});
    }
  }

  Scene& scene = loaded.scene;
  scene.name = path.stem().string();
  SceneReader reader(root);
  visit_scene(reader, scene);
  reader.finish(root);
  apply_scales(scene, root, reader);
  const bool outlet_added = open_outlet(scene);
  choose_cells(root, loaded, reader.findings);

  find_start(root, scene, reader.findings);

  struct Placed {
    int line;
    Diagnostic diagnostic;
  };
  std::vector<Placed> placed;
  const auto place = [&](const YamlNode& node, const std::string& key, const std::string& message,
                         bool fatal) {
    const std::string where =
        node.override_index >= 0 ? "--set " + shown(overrides[node.override_index]) : at_line(node.line);
    placed.push_back({node.override_index >= 0 ? std::numeric_limits<int>::max() : node.line,
                      {where, shown(key), message, fatal}});
  };
  for (const SceneReader::Finding& f : reader.findings) place(*f.node, f.path, f.message, true);
  for (Problem& problem : check(scene)) {
    if (outlet_added && problem.path.starts_with(fmt::format("orifices.{}", scene.orifices.size() - 1)))
      problem.path = "hopper.outlet";  // the file names no such orifice
    const bool follows =               // from what is reported already
        std::any_of(reader.findings.begin(), reader.findings.end(),
                    [&](const SceneReader::Finding& f) {
                      return f.value_lost &&
                             (f.path == problem.path || f.path.starts_with(problem.path + ".") ||
                              problem.path.starts_with(f.path + "."));
                    }) ||
        std::any_of(reader.skipped.begin(), reader.skipped.end(),
                    [&](const std::string& skipped) { return problem.path.starts_with(skipped + "."); });
    if (!follows) place(nearest_node(root, problem.path), problem.path, problem.message, problem.fatal);
  }
  resolve_model(scene);  // after check(), which speaks of what the file gives
  std::stable_sort(placed.begin(), placed.end(),
                   [](const Placed& a, const Placed& b) { return a.line < b.line; });
  for (Placed& p : placed) diagnostics.push_back(std::move(p.diagnostic));
  diagnostics.insert(diagnostics.end(), lost_overrides.begin(), lost_overrides.end());
  return loaded;
}

std::string to_yaml(const Scene& scene) {
  SceneWriter writer;
  Scene copy = scene;
  visit_scene(writer, copy);
  return std::move(writer.out);
}

}  // namespace hourglass
