// The table of keys: what it says of each key holds for scenes, and docs/scene.md says the same.
#include "io/key_table.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <iterator>
#include <map>
#include <set>

#include "tests/support/scene_file.hpp"

using namespace hourglass;

namespace {

const fs::path reference = root / "configs" / "reference.yaml";

/// Dotted paths of all leaves; items of lists count as one, and so do names of materials.
void collect_keys(const YAML::Node& node, const std::string& path, std::set<std::string>& keys) {
  if (node.IsMap()) {
    for (const auto& entry : node) {
      const std::string key = path == "materials" ? "NAME" : entry.first.as<std::string>();
      collect_keys(entry.second, path.empty() ? key : path + "." + key, keys);
    }
  } else if (node.IsSequence() && node.size() > 0 && node[0].IsMap()) {
    for (const auto& item : node) collect_keys(item, path, keys);
  } else {
    keys.insert(path);
  }
}

/// Where the key of a row stands in reference.yaml.
std::string place_of(const std::string& path) {
  const std::vector<std::pair<std::string, std::string>> places{{"materials.NAME.", "materials.sand."},
                                                                {"orifices.", "orifices.0."},
                                                                {"inserts.diameter", "inserts.1.diameter"},
                                                                {"inserts.points", "inserts.2.points"},
                                                                {"inserts.", "inserts.0."},
                                                                {"fill.polygon.", "fill.1.polygon."},
                                                                {"fill.", "fill.0."}};
  for (const auto& [row, place] : places)
    if (path.starts_with(row)) return place + path.substr(row.size());
  return path;
}

/// Whether reference.yaml with this value is refused for the key itself, in words with that part.
bool refused(const std::string& path, const std::string& value, const std::string& part) {
  const std::string place = place_of(path);
  const Loaded loaded = load_scene(reference, {place + "=" + value});
  for (const Diagnostic& d : loaded.diagnostics)
    if (d.fatal && d.path == place && d.message.find(part) != std::string::npos) return true;
  return false;
}

/// A scalar, or a list on one line; "absent".
std::string text_at(const YAML::Node& scene, const std::string& path) {
  YAML::Node node = YAML::Clone(scene);
  for (std::size_t from = 0; from <= path.size();) {
    const std::size_t dot = std::min(path.find('.', from), path.size());
    const std::string step = path.substr(from, dot - from);
    const YAML::Node next = node.IsSequence() ? node[std::stoul(step)] : node[step];
    if (!next) return "absent";
    node.reset(next);
    from = dot + 1;
  }
  if (!node.IsSequence()) return node.as<std::string>();
  std::vector<std::string> items;
  for (const auto& item : node) items.push_back(item.as<std::string>());
  return fmt::format("[{}]", fmt::join(items, ", "));
}

}  // namespace

TEST_CASE("docs/scene.md holds the tables of keys") {
  std::ifstream file(root / "docs" / "scene.md");
  const std::string page{std::istreambuf_iterator(file), {}};
  INFO(
      "The page and solver/scene_keys.hpp differ. Mend the page: ./hourglass pages build --page "
      "docs/scene.md");
  const bool same = with_key_tables(page) == page;  // of which Catch would print both
  CHECK(same);
  CHECK_THROWS_WITH(with_key_tables("no markers"), Catch::Contains("<!-- keys -->"));
}

TEST_CASE("the table of keys, reference.yaml and what is written of it name the same keys") {
  std::set<std::string> listed, shown, kept;
  for (const KeyRow& row : key_rows()) CHECK(listed.insert(row.path).second);
  collect_keys(YAML::LoadFile(reference.string()), "", shown);
  collect_keys(YAML::Load(to_yaml(load_scene(reference).scene)), "", kept);
  CHECK(shown == kept);
  shown.insert({"physics.wall_friction.mu_w", "physics.wall_friction.gap"});  // instead of F
  shown.insert({"start.run", "start.time"});                                  // a run must be there
  shown.insert("accuracy.preset");                                            // its values are written
  CHECK(listed == shown);
}

TEST_CASE("numbers just outside of a key's range are refused for that key, just inside they are not") {
  REQUIRE(load_scene(reference).ok());
  int ends = 0;
  for (const KeyRow& row : key_rows()) {
    if (!row.range.has_ends()) continue;
    const auto try_end = [&](double end, double outwards, bool without_end) {
      const auto beside = [&](double way) {
        return row.unit.empty() ? end + std::copysign(1, way) : std::nextafter(end, way);
      };
      const double inside = without_end ? beside(-outwards) : end,
                   outside = without_end ? end : beside(outwards);
      INFO(row.path << ": " << inside << " inside, " << outside << " outside");
      CHECK_FALSE(refused(row.path, fmt::format("{}", inside), "out of range"));
      CHECK(refused(row.path, fmt::format("{}", outside),
                    fmt::format("is out of range (must be {}).", row.range.words())));
      ++ends;
    };
    try_end(row.range.low, -INFINITY, row.range.without_low);
    if (row.range.high < INFINITY) try_end(row.range.high, INFINITY, row.range.without_high);
  }
  CHECK(ends > 80);
}

TEST_CASE("the words of a key are accepted, others are not") {
  int keys = 0;
  for (const KeyRow& row : key_rows()) {
    if (row.words.empty()) continue;
    INFO(row.path);
    for (const std::string& word : row.words) CHECK_FALSE(refused(row.path, word, "allowed"));
    CHECK(refused(row.path, "no_such_word", fmt::format("(allowed: {}).", fmt::join(row.words, ", "))));
    ++keys;
  }
  CHECK(keys > 25);
}

TEST_CASE("a key that is not given has the default that the table says") {
  // Words of the table that are not the value itself, in the scene below.
  const double phi = std::asin(0.62) * 180 / M_PI, Q = std::pow(18.75, 1.5);
  const std::map<std::string, double> values{{"auto", 128},
                                             {"d", 1},
                                             {"2 d", 2},
                                             {"4 d", 4},
                                             {"rho", 1},
                                             {"sqrt(d/g)", 1},
                                             {"rho sqrt(g d^3)", 1},
                                             {"asin(mu_s)", phi},
                                             {"phi/2", phi / 2},
                                             {"that of the hopper, else 90 - phi", 90 - phi},
                                             {"sum of rho sqrt(g) W^1.5", Q},
                                             {"rho sqrt(g) W^1.5, around an axis W^2.5", Q}};
  const std::set<std::string> none{"no such stop", "that of `physics.nonlocal`",
                                   "that of `physics.dilatancy`", "that of `physics.wall_friction`"};
  const File file(
      "domain: {width: 150, height: 150}\n"
      "materials: {sand: {}}\n"
      "fill: [{material: sand, box: {x: [0, 150], y: [0, 135]}}]\n"
      "orifices: [{centre: 75, width: 18.75}]\n");
  std::map<std::string, YAML::Node> scenes;
  for (const std::string model : model_names) {  // the others need no time, and can have no modules
    const Loaded loaded = load_scene(
        file.path(),
        {model == "mu_I" ? "physics={nonlocal: {}, dilatancy: {}, wall_friction: {F: 1}}" : "time={}",
         model == "mu_I" ? "time.end=1" : "model=" + model});
    INFO(messages(loaded));
    REQUIRE(loaded.ok());
    scenes[model] = YAML::Load(to_yaml(loaded.scene));
  }
  int defaults = 0;
  for (const KeyRow& row : key_rows()) {
    if (row.by_default == "-" || row.path.starts_with("start.") || row.path == "accuracy.preset") continue;
    const std::string block = row.path.substr(0, row.path.find('.'));
    const std::string model = scenes.contains(block) ? block : block == "time" ? "kinematic" : "mu_I";
    const std::string found = text_at(scenes[model], place_of(row.path));
    INFO(row.path << ": " << row.by_default << ", found " << found);
    if (row.path == "name")
      CHECK(found == file.path().stem());
    else if (none.contains(row.by_default))
      CHECK(found == "absent");
    else if (values.contains(row.by_default))
      CHECK(std::stod(found) == Approx(values.at(row.by_default)));
    else if (found != row.by_default)
      CHECK(std::stod(found) == std::stod(row.by_default));  // 1e-3 is 0.001, "0.0164 rho sqrt(g d^3)" 0.0164
    ++defaults;
  }
  CHECK(defaults > 70);
}
