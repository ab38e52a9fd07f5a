#include "io/run_folder.hpp"

#include <fmt/format.h>
#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <optional>
#include <regex>
#include <stdexcept>

#include "io/checkpoint.hpp"
#include "io/files.hpp"
#include "io/json.hpp"
#include "io/offscreen.hpp"
#include "io/progress.hpp"
#include "io/provenance.hpp"
#include "io/render.hpp"
#include "io/series.hpp"
#include "io/xdmf.hpp"
#include "io/yaml_tree.hpp"

namespace hourglass {
namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
namespace {

constexpr const char* log_name = "run.log";
constexpr std::size_t summary_room = 64 << 10;  ///< bytes; a summary takes 2 KiB and its warnings
constexpr const char* log_mark = "hourglass";   ///< in the first line of every run.log
constexpr const char* file_names[] = {
    log_name,      "scene.yaml",    "series.csv",   "fields.h5",
    "fields.xdmf", checkpoint_name, "summary.json", previous_checkpoint_name};

/// Of <field>_<four or more digits>.png with a field of ours; nullopt: it is none.
std::optional<long> picture_number(const fs::path& path) {
  static const std::regex pattern("(.+)_([0-9]{4,})[.]png");
  std::smatch match;
  const std::string name = path.filename().string();
  const bool ours = std::regex_match(name, match, pattern) &&
                    std::any_of(known_fields().begin(), known_fields().end(),
                                [&](const FieldInfo& info) { return match[1] == info.name; });
  return ours ? std::optional(std::stol(match[2])) : std::nullopt;
}

std::vector<fs::path> pictures_in(const fs::path& folder, long from = 0) {
  std::vector<fs::path> found;
  if (!fs::is_directory(folder)) return found;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.is_regular_file() && picture_number(entry.path()).value_or(-1) >= from)
      found.push_back(entry.path());
  return found;
}

/// What a run wrote, or would write, into this folder. Empty files do not count: they are what a full disk
/// leaves of a run that could not begin.
std::vector<fs::path> files_of_run(const fs::path& folder) {
  const auto holds_something = [](const fs::path& path) {
    return fs::is_regular_file(path) && !fs::is_empty(path);
  };
  std::vector<fs::path> found;
  for (const char* name : file_names) {
    for (const char* suffix : {"", ".new"}) {  // .new: a killed run may leave one behind
      if (fs::path path = folder / fmt::format("{}{}", name, suffix); holds_something(path))
        found.push_back(path);
    }
  }
  for (const FieldInfo& field : known_fields()) {
    if (fs::path path = folder / fmt::format("{}.ogv", field.name); holds_something(path))
      found.push_back(path);
  }
  for (const char* pictures : {"snapshots", "pictures", "frames"})
    for (fs::path& path : pictures_in(folder / pictures)) found.push_back(std::move(path));
  return found;
}

bool written_by_run(const fs::path& folder) {
  std::ifstream log(folder / log_name);
  std::string line;
  return std::getline(log, line) && line.find(log_mark) != std::string::npos;
}

[[noreturn]] void refuse(const fs::path& folder, const std::string& why) {
  throw std::invalid_argument(fmt::format("{}: {}", folder.string(), why));
}

/// Throws std::invalid_argument unless a run may begin here.
void make_way(const fs::path& folder, bool force) {
  if (!holds_run(folder)) return;
  if (!force)
    refuse(folder,
           "holds a run already; go on with it with --resume, replace it with --force, or choose another "
           "folder with --out");
  // The log last: it shows that the rest is ours, should the program be killed on the way.
  const std::vector<fs::path> files = files_of_run(folder);
  std::for_each(files.rbegin(), files.rend(), [](const fs::path& path) { fs::remove(path); });
}

long peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss * 1024L;
}

std::string to_json(const Extrapolation& e) {
  std::vector<std::string> cells, rates;
  for (const long n : e.cells) cells.push_back(json_number(n));
  for (const double rate : e.discharge_rates) rates.push_back(json_number(rate));
  JsonMembers members{{"cells", json_array(cells)},
                      {"discharge_rates", json_array(rates)},
                      {"order", json_number(e.order)},
                      {"discharge_rate", json_number(e.discharge_rate)},
                      {"error_bar", json_number(e.error_bar)},
                      {"quasi_static_fraction", json_number(e.quasi_static_fraction)},
                      {"quasi_static_error_bar", json_number(e.quasi_static_error_bar)},
                      {"seconds", json_number(e.seconds)}};
  if (e.step_change) members.emplace_back("step_change", json_number(*e.step_change));
  return json_object(members, 2);
}

std::string to_json(const Summary& s, Model model) {
  JsonMembers stages;
  for (const auto& [stage, seconds] : s.stages) stages.emplace_back(stage, json_number(seconds));
  std::vector<std::string> warnings;
  for (const std::string& warning : s.warnings) warnings.push_back(json_string(warning));
  JsonMembers members{{"model", json_string(model_names[static_cast<int>(model)])},
                      {"status", json_string(name_of(s.status))},
                      {"reason", json_string(s.reason)},
                      {"discharge_rate", json_number(s.discharge_rate)},
                      {"discharge_constant", json_number(s.discharge_constant)},
                      {"discharge_window",
                       json_array({json_number(s.discharge_window[0]), json_number(s.discharge_window[1])})},
                      {"quasi_static_fraction", json_number(s.quasi_static_fraction)},
                      {"quasi_static_1e-2", json_number(s.quasi_static_1e2)},
                      {"quasi_static_1e-4", json_number(s.quasi_static_1e4)},
                      {"mass_error", json_number(s.mass_error)},
                      {"worst_max_divergence", json_number(s.worst_max_divergence)},
                      {"missed_tolerances", json_number(s.missed_tolerances)},
                      {"back_offs", json_number(s.back_offs)},
                      {"steps", json_number(s.steps)},
                      {"cells", json_number(s.cells)},
                      {"wall_seconds", json_number(s.wall_seconds)},
                      {"cell_steps_per_second", json_number(s.cell_steps_per_second)},
                      {"peak_memory_bytes", json_number(peak_memory_bytes())},
                      {"threads", json_number(long{s.threads})},
                      {"stages", json_object(stages, 2)},
                      {"warnings", json_array(warnings)},
                      {"provenance", to_json(provenance(s.threads), 2)}};
  const auto insert_after = [&](const char* name, const std::string& key, const std::string& value) {
    const auto at = std::ranges::find(members, name, &JsonMembers::value_type::first);
    members.insert(at + 1, {key, value});
  };
  if (s.extrapolation) insert_after("discharge_window", "extrapolation", to_json(*s.extrapolation));
  if (s.quasi_static_above_flat_top)
    insert_after("quasi_static_1e-4", "quasi_static_above_flat_top",
                 json_number(*s.quasi_static_above_flat_top));
  return json_object(members) + '\n';
}

std::string text_of(const Extrapolation& e) {
  return fmt::format(
      "extrapolated from {} grids: discharge rate {:.6g} +- {:.2g} (order {:.2g}), quasi-static share "
      "{:.4g} +- {:.2g}; {:.6g} on the finest",
      e.cells.size(), e.discharge_rate, e.error_bar, e.order, e.quasi_static_fraction,
      e.quasi_static_error_bar, e.discharge_rates.back());
}

std::shared_ptr<spdlog::logger> open_log(const fs::path& path, bool anew) {
  try {
    auto log = std::make_shared<spdlog::logger>(
        "run", std::make_shared<spdlog::sinks::basic_file_sink_st>(path, anew));
    log->set_pattern("%Y-%m-%d %H:%M:%S %v");
    log->flush_on(spdlog::level::info);
    log->set_error_handler([](const std::string&) {});  // a full disk is told by the other files
    return log;
  } catch (const spdlog::spdlog_ex& error) {
    throw std::runtime_error(error.what());
  }
}

}  // namespace

fs::path default_run_folder(const std::string& scene_name) {
  std::string name = scene_name.empty() ? "_" : scene_name;
  for (char& c : name) {
    if (c == '/' || c == '\\' || static_cast<unsigned char>(c) < 0x20) c = '_';
  }
  for (std::size_t k = 0; k < name.size() && name[k] == '.'; ++k) name[k] = '_';
  return fs::path("runs") / name;
}

fs::path run_folder_of(const Scene& scene, const RunOptions& options) {
  return options.out.empty() ? default_run_folder(scene.name) : options.out;
}

/// What a run writes stays in its folder. Throws std::invalid_argument where a link would lead it elsewhere.
static void refuse_links(const fs::path& folder) {
  std::vector<std::string> names{"snapshots", "pictures", "frames"};
  for (const char* name : file_names)
    for (const char* suffix : {"", ".new"}) names.push_back(fmt::format("{}{}", name, suffix));
  for (const std::string& name : names)
    if (fs::is_symlink(folder / name))
      refuse(
          folder,
          fmt::format("{} is a link, and a run writes into its own folder only; remove it, or choose another "
                      "folder with --out",
                      name));
}

bool holds_run(const fs::path& folder) {
  refuse_links(folder);
  if (!fs::exists(folder)) return false;
  if (!fs::is_directory(folder)) refuse(folder, "is a file; choose another folder with --out");
  const std::vector<fs::path> found = files_of_run(folder);
  if (!found.empty() && !written_by_run(folder))
    refuse(folder,
           fmt::format("holds {}, not written by a run of hourglass; choose another folder with --out",
                       found.front().filename().string()));
  return !found.empty();
}

std::string status_of_run(const fs::path& folder) {
  const std::string text = text_at(folder / "summary.json");
  if (text.empty()) return {};
  const YamlNode summary = parse_yaml(text);  // JSON is YAML
  const YamlNode* status = summary.find("status");
  return status ? status->text : "";
}

struct RunFolder::Impl {
  Impl(const Scene& scene, const std::string& resolved_yaml, const RunOptions& options,
       const std::vector<std::string>& warnings)
      : path(run_folder_of(scene, options)), lock(path, "run"), info(info_of(scene)), model(scene.model),
        draws(scene.output.snapshots_every > 0), stored(stored_fields(scene)), drawn(asked_fields(scene)),
        progress(options.quiet),
        checkpoint_pause(std::chrono::duration_cast<Clock::duration>(
            std::chrono::duration<double, std::ratio<60>>(scene.output.checkpoint_minutes))) {
    if (options.from)
      go_back_to(*options.from, scene);
    else
      make_way(path, options.force);
    log = open_log(path / log_name, !options.from);
    reserve_write(path / "summary.json", summary_room);
    const Provenance p = provenance(scene.threads);
    log->info("{} {}, revision {}: scene '{}'", log_mark, p.version, p.revision, scene.name);
    log->info("{} ({}), SIMD width {} bits: {}", p.compiler, p.build_type, p.simd_bits, p.flags);
    log->info("{}, {}, {} cores, {} threads", p.host, p.cpu, p.cores, p.threads);
    log->info("{} x {} cells, side {:.6g} {}", info.patch.nx, info.patch.ny, info.patch.h,
              unit_text("L", info.units));
    for (const std::string& warning : warnings) log->info("{}", warning);
    write_atomically(path / "scene.yaml", resolved_yaml);
    if (!options.from) {
      series.emplace(series_path(), scene);
      if (scene.output.fields_every > 0) frames.emplace(path, info, scene.output.compression);
    }
    next_checkpoint = Clock::now() + checkpoint_pause;
  }

  fs::path series_path() const { return path / "series.csv"; }

  /// What a checkpoint holds of the folder.
  void walk(Archive& archive) {
    archive.group("folder", [&] {
      if (!archive.restoring()) series_bytes = fs::file_size(series_path());
      archive.number("series_bytes", series_bytes);
      int stored_frames = frames ? frames->frames() : 0;
      archive.number("frames", stored_frames);
      if (archive.restoring()) frames_before = stored_frames;
      archive.number("snapshots", snapshots);
      archive.texts("warnings", own_warnings);
    });
  }

  /// Leaves in the folder what was there when the checkpoint was written.
  void go_back_to(Archive& checkpoint, const Scene& scene) {
    walk(checkpoint);
    if (!fs::exists(series_path()) || fs::file_size(series_path()) < series_bytes)
      refuse(path, "series.csv is shorter than when the checkpoint was written; run again with --force");
    // Rows first: at no moment is there a row without its frame.
    fs::resize_file(series_path(), series_bytes);
    series.emplace(series_path());
    if (scene.output.fields_every > 0)
      frames.emplace(path, info, stored, frames_before, scene.output.compression);
    for (const fs::path& picture : pictures_in(path / "snapshots", snapshots)) fs::remove(picture);
    fs::remove(path / "summary.json");
  }

  void warn(const std::string& warning) {
    log->info("warning: {}", warning);
    progress.end();
    tell("warning: " + warning);
  }

  /// A picture of each field; none, with a warning, where there is no OpenGL.
  void draw(const Frame& frame) {
    try {
      std::error_code error;
      fs::create_directories(path / "snapshots", error);
      if (error)
        throw std::runtime_error(fmt::format("{}: {}", (path / "snapshots").string(), error.message()));
      for (const std::string& field : drawn)
        render_png(picture_of(field, frame, info), snapshot_path(path, field, snapshots));
      ++snapshots;
    } catch (const NoGraphics& error) {
      can_draw = false;
      if (fs::is_empty(path / "snapshots")) fs::remove(path / "snapshots");
      const std::string words =
          fmt::format("no snapshots: {}. Draw them later with 'hourglass render'.", error.what());
      if (std::ranges::find(own_warnings, words) != own_warnings.end()) return;  // said before a break
      own_warnings.push_back(words);
      warn(words);
    }
  }

  const fs::path path;
  const FolderLock lock;
  const RunInfo info;
  const Model model;
  const bool draws;
  const std::vector<std::string> stored, drawn;  ///< names of fields
  std::shared_ptr<spdlog::logger> log;
  std::optional<SeriesFile> series;
  std::optional<FieldWriter> frames;
  std::vector<std::string> own_warnings;
  bool can_draw = true;
  int snapshots = 0;
  std::uintmax_t series_bytes = 0;  ///< at the checkpoint
  int frames_before = 0;            ///< the same

  Progress progress;
  Clock::time_point shown = Clock::now();
  Clock::duration writing{};  ///< since then, which is no part of steps/s
  long shown_step = -1;       ///< none yet

  const Clock::duration checkpoint_pause;
  Clock::time_point next_checkpoint;
};

RunFolder::RunFolder(const Scene& scene, const std::string& resolved_yaml, const RunOptions& options,
                     const std::vector<std::string>& warnings)
    : impl_(std::make_unique<Impl>(scene, resolved_yaml, options, warnings)) {}
RunFolder::~RunFolder() = default;

const fs::path& RunFolder::path() const { return impl_->path; }

void RunFolder::on_series(const SeriesRow& row) {
  impl_->series->write(row);
  const StepReport& s = row.step;
  const auto solve = [](const SolveStats& stats) {
    return fmt::format("{}{}", stats.iterations, stats.converged ? "" : " (tolerance missed)");
  };
  impl_->log->info(
      "t {:.6g}  step {}  dt {:.4g} by {}  iterations: pressure {}, viscous {}  max |div u| dt {:.2g}  "
      "capped cells {}"
      "  mass {:.8g}  outflow {:.6g}  max speed {:.4g}",
      s.t, s.step, s.dt, name_of(s.limit), solve(s.pressure), solve(s.viscous), s.max_divergence,
      s.capped_cells, row.mass, row.outflow, row.max_speed);
}

void RunFolder::on_fields(const Simulation& simulation) {
  const auto start = Clock::now();
  if (impl_->frames) impl_->frames->write(frame_of(simulation, impl_->stored));
  impl_->writing += Clock::now() - start;
}

void RunFolder::on_snapshot(const Simulation& simulation) {
  if (!impl_->can_draw) return;
  const auto start = Clock::now();
  impl_->draw(frame_of(simulation, impl_->stored));
  impl_->writing += Clock::now() - start;
}

void RunFolder::write(const SteadyFlow& flow) {
  on_series(flow.row);
  const Frame frame = frame_of(flow, impl_->stored);
  if (impl_->frames) impl_->frames->write(frame);
  if (impl_->draws) impl_->draw(frame);
}

void RunFolder::on_step(const StepReport& report, double fraction_done) {
  if (!impl_->progress.due(fraction_done)) return;
  const auto now = Clock::now();
  if (impl_->shown_step < 0) impl_->shown_step = report.step - 1;
  const double seconds = std::chrono::duration<double>(now - impl_->shown - impl_->writing).count();
  impl_->progress.show(
      fraction_done, fmt::format("t {:.4g}  dt {:.3g}  {:.3g} steps/s  iterations {}+{}", report.t, report.dt,
                                 seconds > 0 ? (report.step - impl_->shown_step) / seconds : 0.0,
                                 report.pressure.iterations, report.viscous.iterations));
  impl_->shown = now;
  impl_->writing = {};
  impl_->shown_step = report.step;
}

bool RunFolder::wants_checkpoint() {
  return impl_->checkpoint_pause.count() > 0 && Clock::now() >= impl_->next_checkpoint;
}

void RunFolder::on_checkpoint(const Simulation& simulation, const Walk& walk) {
  // Nothing that the checkpoint counts on may be younger on the disk than it.
  sync_to_disk(impl_->series_path());
  if (impl_->frames) sync_to_disk(impl_->path / "fields.h5");
  write_checkpoint(impl_->path, simulation.scene(), simulation.t(), simulation.steps(),
                   [&](Archive& archive) {
                     walk(archive);
                     impl_->walk(archive);
                   });
  impl_->log->info("checkpoint: t {:.6g}  step {}", simulation.t(), simulation.steps());
  impl_->next_checkpoint = Clock::now() + impl_->checkpoint_pause;
}

void RunFolder::on_warning(const std::string& warning) { impl_->warn(warning); }

void RunFolder::say(const std::string& line) {
  impl_->log->info("{}", line);
  impl_->progress.say(line);
}

void RunFolder::finish(const Summary& of_simulation) {
  Summary summary = of_simulation;
  summary.warnings.insert(summary.warnings.end(), impl_->own_warnings.begin(), impl_->own_warnings.end());
  write_atomically(impl_->path / "summary.json", to_json(summary, impl_->model));
  const std::string how = fmt::format("{}: {}; {} steps in {}", name_of(summary.status), summary.reason,
                                      summary.steps, duration_text(summary.wall_seconds));
  impl_->log->info("{}", how);
  if (summary.extrapolation) say(text_of(*summary.extrapolation));
  impl_->progress.say(fmt::format("{}: {}", impl_->path.string(), how));
}

}  // namespace hourglass
