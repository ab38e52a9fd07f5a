// The command line: parse, load the scene, run, exit code.
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "io/checkpoint.hpp"
#include "io/command_pages.hpp"
#include "io/files.hpp"
#include "io/fit_run.hpp"
#include "io/forecast.hpp"
#include "io/key_table.hpp"
#include "io/plan.hpp"
#include "io/progress.hpp"
#include "io/provenance.hpp"
#include "io/render.hpp"
#include "io/run_folder.hpp"
#include "io/scene_yaml.hpp"
#include "io/start.hpp"
#include "solver/simulation.hpp"
#include "studies/extrapolation.hpp"
#include "studies/figures.hpp"
#include "studies/limits.hpp"
#include "studies/measure.hpp"
#include "studies/report.hpp"
#include "studies/sweep.hpp"
#include "studies/trade.hpp"

using namespace hourglass;

namespace {

enum Exit { finished = 0, failed = 1, wrong_input = 2, by_signal = 128 };

volatile std::sig_atomic_t caught_signal = 0;
timespec caught_at{};

/// A further signal ends the program at once. Not within half a second, for many come twice: `timeout` sends it to the
/// process and to its group, a terminal to all of a sweep, which sends another on.
void catch_signal(int signal) {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  if (caught_signal == 0) {
    caught_at = now;
    caught_signal = signal;
  } else if (static_cast<double>(now.tv_sec - caught_at.tv_sec) +
                 1e-9 * static_cast<double>(now.tv_nsec - caught_at.tv_nsec) >
             0.5) {
    std::_Exit(by_signal + signal);
  }
}

/// Ends a run after the step at hand when a signal asks for it.
class SignalWatch : public Observer {
 public:
  SignalWatch() {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP})
      if (std::signal(signal, catch_signal) == SIG_IGN && signal == SIGHUP)
        std::signal(signal, SIG_IGN);  // nohup
  }
  std::string interrupt() override {
    if (!caught_signal) return {};
    return std::string("interrupted by SIG") + sigabbrev_np(caught_signal);
  }
};

struct Arguments {
  std::string scene, study, out, run, executor = "local";
  std::vector<std::string> sets, overlays;
  std::vector<std::filesystem::path> files{"configs/figures"};
  std::string quality = "quick", page;
  RenderOptions render;
  MeasureOptions measure;
  std::optional<double> budget;
  std::optional<double> fit_time;
  std::string csv;
  int threads = -1, jobs = 0;
  bool resume = false, force = false, quiet = false, dry_run = false, quick = false;
};

/// Prints what is wrong with the scene, or doubtful, and what was chosen for it.
void print(const Loaded& loaded) {
  for (const Diagnostic& d : loaded.diagnostics) tell(d.text());
  for (const std::string& note : loaded.notes) tell(note);
}

Loaded load(const Arguments& a) {
  std::vector<std::string> sets = a.sets;
  if (a.threads >= 0) sets.push_back(fmt::format("threads={}", a.threads));
  return load_scene(a.scene, sets);
}

/// The run, after those on coarser grids that the scene asks for.
Summary run_with_extrapolation(Simulation& simulation, RunFolder& folder, SignalWatch& watch, bool quiet,
                               Archive* from) {
  const Scene& scene = simulation.scene();
  if (scene.accuracy.extrapolate == 0 || scene.orifices.empty())
    return simulation.run({&folder, &watch}, from);
  const CoarseRuns coarse = run_coarser(scene, quiet, watch);
  Summary summary;
  if (coarse.interrupted) {
    summary.status = Status::interrupted;
    summary.reason = watch.interrupt() + ", on a coarser grid (accuracy.extrapolate)";
    return summary;
  }
  summary = simulation.run({&folder, &watch}, from);
  const std::size_t before = summary.warnings.size();
  extrapolate(coarse, summary);
  for (std::size_t k = before; k < summary.warnings.size(); ++k) folder.on_warning(summary.warnings[k]);
  return summary;
}

int run(const Arguments& a) {
  const Loaded loaded = load(a);
  print(loaded);
  if (!loaded.ok()) return wrong_input;

  std::vector<std::string> warnings;
  for (const Diagnostic& d : loaded.diagnostics) warnings.push_back(d.text());
  warnings.insert(warnings.end(), loaded.notes.begin(), loaded.notes.end());
  RunOptions options{.out = a.out, .force = a.force, .quiet = a.quiet};
  std::optional<Checkpoint> checkpoint;
  if (a.resume) {
    Resumption resumed = resume(run_folder_of(loaded.scene, options), loaded.scene);
    for (const std::string& words : resumed.words) tell(words);
    if (resumed.done) return finished;
    warnings.insert(warnings.end(), resumed.words.begin(), resumed.words.end());
    checkpoint = std::move(resumed.from);
    options.from = checkpoint ? checkpoint->state.get() : nullptr;
    options.force = true;  // what is there is of this very scene
  }
  if (loaded.scene.model != Model::mu_I) {
    const SteadyFlow flow = steady_flow(loaded.scene);
    RunFolder folder(loaded.scene, to_yaml(loaded.scene), options, warnings);
    folder.write(flow);
    folder.finish(flow.summary);
    return finished;
  }
  SignalWatch watch;
  Simulation simulation(loaded.scene);  // before the folder: if memory is short nothing is written
  if (!checkpoint) begin(simulation);
  RunFolder folder(loaded.scene, to_yaml(loaded.scene), options, warnings);
  if (checkpoint) folder.say(fmt::format("resumed at t = {:.6g}, step {}", checkpoint->t, checkpoint->step));
  const Summary summary = run_with_extrapolation(simulation, folder, watch, a.quiet, options.from);
  folder.finish(summary);

  if (summary.status == Status::finished || summary.status == Status::stopped) return finished;
  if (caught_signal && summary.reason.starts_with(watch.interrupt())) return by_signal + caught_signal;
  tell(summary.reason);
  return failed;
}

int render(Arguments a) {
  for (const std::string& name : a.overlays) {
    const auto at = std::find(overlay_names.begin(), overlay_names.end(), name);
    a.render.overlays.push_back(static_cast<Overlay>(at - overlay_names.begin()));
  }
  return render_run(a.run, a.render);
}

int fit(const Arguments& a) {
  const RunFit fitted = fit_run(a.run, a.fit_time);
  fmt::print("{}", text_of(fitted));
  if (!a.csv.empty()) write_atomically(a.csv, csv_of(fitted));
  return finished;
}

/// What a run of the scene would be. Writes nothing.
int plan(const Arguments& a) {
  const Loaded loaded = load(a);
  print(loaded);
  if (!loaded.ok()) return wrong_input;
  const Scene& scene = loaded.scene;
  const Patch patch = scene.patch();
  if (scene.model != Model::mu_I) {
    fmt::print("{}: {} x {} cells of side {:.6g}\n\n{}", a.scene, patch.nx, patch.ny, patch.h,
               steady_text(scene));
    return finished;
  }
  fmt::print(
      "{}: {} x {} cells of side {:.6g}\n\nSwitched on\n{}\nWell-posedness, C(I) of Barker et al. 2015\n{}",
      a.scene, patch.nx, patch.ny, patch.h, text_of(switches_of(scene)), well_posedness_text(scene));
  fmt::print("\nMemory\n{}", memory_text(Simulation(scene)));
  std::fflush(stdout);  // the rest takes a second or two
  fmt::print("\nSteps and seconds\n{}", text_of(forecast(scene), scene));
  return finished;
}

int check(const Arguments& a) {
  const Loaded loaded = load(a);
  print(loaded);
  if (!loaded.ok()) return wrong_input;
  const Patch patch = loaded.scene.patch();
  fmt::print("{}: the scene is sound, {} x {} cells of side {:.6g}.\n", a.scene, patch.nx, patch.ny, patch.h);
  if (loaded.scene.model != Model::mu_I) {
    fmt::print("{}", steady_text(loaded.scene));
    return finished;
  }
  fmt::print("Well-posedness, C(I) of Barker et al. 2015:\n{}", well_posedness_text(loaded.scene));
  const SolveStats stats = project_noise(loaded.scene);
  fmt::print(
      "One projection of noise: {} iterations, max |div u| dt from {:.3g} to {:.3g} (tolerance {:.3g}).\n",
      stats.iterations, stats.initial, stats.final, stats.tolerance);
  if (stats.converged) return finished;
  tell(fmt::format("The projection missed its tolerance, worst at cell ({}, {}).", stats.worst_i,
                   stats.worst_j));
  return failed;
}

int limits(const Arguments& a) {
  const Loaded loaded = load(a);
  print(loaded);
  if (!loaded.ok()) return wrong_input;
  const std::string out = a.out.empty() ? "limits/" + loaded.scene.name : a.out;
  measure_limits(loaded.scene, {out, a.quick});
  return finished;
}

int trade(const Arguments& a) {
  SignalWatch watch;
  const bool ended = hourglass::trade({.scene = a.scene,
                                       .sets = a.sets,
                                       .out = a.out,
                                       .budget = a.budget,
                                       .threads = a.threads < 0 ? 1 : a.threads,
                                       .force = a.force,
                                       .dry_run = a.dry_run,
                                       .observers = {&watch}});
  return ended ? finished : by_signal + caught_signal;
}

int sweep(const Arguments& a) {
  SignalWatch watch;
  const SweepResult result =
      hourglass::sweep({.study = a.study,
                        .out = a.out,
                        .executor = a.executor == executor_names[1] ? Executor::slurm : Executor::local,
                        .jobs = a.jobs,
                        .force = a.force,
                        .dry_run = a.dry_run,
                        .observers = {&watch}});
  if (result.interrupted) return by_signal + caught_signal;
  if (result.lost > 0) return failed;
  return result.failed > 0 && result.failed == result.runs ? failed : finished;
}

int report(const Arguments& a) {
  fmt::print("{}\n", hourglass::report(a.run, a.out).string());
  return finished;
}

int figures(const Arguments& a) {
  SignalWatch watch;
  const std::string out = a.out.empty() ? "figures" : a.out;
  if (!a.page.empty()) {
    write_figures_page(a.files, out, a.page);
    return finished;
  }
  const FiguresResult result = make_figures({.files = a.files,
                                             .quality = a.quality,
                                             .out = out,
                                             .jobs = a.jobs,
                                             .force = a.force,
                                             .dry_run = a.dry_run,
                                             .observers = {&watch}});
  if (result.interrupted) return by_signal + caught_signal;
  return result.fail > 0 ? failed : finished;
}

int measure(const Arguments& a) {
  hourglass::measure(a.run, a.measure);
  return finished;
}

int write_pages(const CLI::App& app, const Arguments& a) {
  if (!a.page.empty()) {
    std::ifstream file(a.page, std::ios::binary);
    write_atomically(a.page, with_key_tables({std::istreambuf_iterator(file), {}}));
  }
  const std::filesystem::path folder = a.out;
  write_atomically(folder / "hourglass.1", man_page(app, provenance().version));
  write_atomically(folder / "hourglass.bash", bash_completion(app));
  write_atomically(folder / "hourglass.zsh", zsh_completion(app));
  write_atomically(folder / "keys.md", key_table() + "\n" + accuracy_table());
  return finished;
}

}  // namespace

int main(int argc, char** argv) try {
  // The next file to be opened would get the number of a standard stream that the caller has closed, and its
  // words.
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(stream, F_GETFD) < 0) ::open("/dev/null", O_RDWR);
  Arguments a;
  CLI::App app{"Granular silo flow: mu(I) rheology, geometric VOF, multigrid projection.", "hourglass"};
  app.set_version_flag("--version", version_text);
  app.require_subcommand(1);
  const auto takes_scene = [&](CLI::App* command) {
    command->add_option("scene", a.scene, "scene file (YAML)")->required()->type_name("SCENE.yaml");
    command
        ->add_option("--set", a.sets,
                     "change a key for this run, e.g. orifices.0.width=9.375; may be repeated")
        ->type_name("path=value")
        ->allow_extra_args(false);
    command->add_option("--threads", a.threads, "threads to run on; 0: as many as there are cores")
        ->type_name("N")
        ->check(CLI::Range(0, 1024));
  };

  CLI::App* run_command = app.add_subcommand("run", "run a scene; results go to one folder");
  takes_scene(run_command);
  run_command->add_option("--out", a.out, "run folder (default: runs/<name of the scene>)")->type_name("DIR");
  run_command->add_flag("--resume", a.resume, "go on with the run in the folder, from its last checkpoint");
  run_command->add_flag("--force", a.force, "replace an earlier run in the same folder")
      ->excludes("--resume");
  run_command->add_flag("--quiet", a.quiet, "no progress on standard output");

  CLI::App* check_command =
      app.add_subcommand("check", "say what is wrong with a scene, and project noise with its boundaries");
  takes_scene(check_command);

  CLI::App* plan_command = app.add_subcommand(
      "plan",
      "say what a scene switches on, what it allocates, how many steps and seconds it takes; runs nothing");
  takes_scene(plan_command);

  CLI::App* limits_command = app.add_subcommand(
      "limits",
      "measure where short waves grow over the planes of friction and of viscosity, and what each cure does");
  takes_scene(limits_command);
  limits_command
      ->add_option("--out", a.out,
                   "folder (default: limits/<name of the scene>); what is measured in it stays")
      ->type_name("DIR");
  limits_command->add_flag("--quick", a.quick, "a coarse map");
  CLI::App* trade_command = app.add_subcommand(
      "trade", "measure what speed costs in accuracy: every lever, against a reference of the scene's own");
  takes_scene(trade_command);
  trade_command
      ->add_option("--out", a.out, "folder (default: trades/<name of the scene>); a trade in it goes on")
      ->type_name("DIR");
  trade_command->add_option("--budget", a.budget, "leave out what does not fit into so many minutes")
      ->type_name("MINUTES")
      ->check(CLI::PositiveNumber);
  trade_command->add_flag("--force", a.force, "begin anew in the same folder");
  trade_command->add_flag("--dry-run", a.dry_run, "print the runs and about how long they take");

  CLI::App* sweep_command =
      app.add_subcommand("sweep", "run a scene over axes of parameters: one table, one folder");
  sweep_command->add_option("study", a.study, "study file (YAML)")->required()->type_name("STUDY.yaml");
  sweep_command
      ->add_option("--jobs", a.jobs, "runs at a time (default: by the cores and the cells of the runs)")
      ->type_name("N")
      ->check(CLI::Range(1, 1024));
  sweep_command->add_option("--executor", a.executor, "where the runs are executed: local or slurm")
      ->check(CLI::IsMember(std::vector<std::string>(executor_names.begin(), executor_names.end())));
  sweep_command
      ->add_option("--out", a.out, "folder (default: sweeps/<name of the study>); a sweep in it goes on")
      ->type_name("DIR");
  sweep_command->add_flag("--resume", a.resume, "go on with a sweep, as happens without it too");
  sweep_command->add_flag("--force", a.force, "begin anew in the same folder");
  sweep_command->add_flag("--dry-run", a.dry_run, "print the runs and about how long they take");

  CLI::App* figures_command =
      app.add_subcommand("figures", "the figures of the thesis: run, judged by what each must show, drawn");
  figures_command->add_option("files", a.files, "figure files, or folders of them (default: configs/figures)")
      ->type_name("FILE|FOLDER")
      ->check(CLI::ExistingPath);
  figures_command->add_option("--quality", a.quality, "quick: coarse grids; full: 256 cells across")
      ->check(CLI::IsMember(std::vector<std::string>{"quick", "full"}));
  figures_command
      ->add_option("--jobs", a.jobs, "runs at a time (default: by the cores and the cells of the runs)")
      ->type_name("N")
      ->check(CLI::Range(1, 1024));
  figures_command
      ->add_option("--out", a.out, "folder (default: figures); what has ended in it is not run again")
      ->type_name("DIR");
  figures_command
      ->add_option("--page", a.page, "only write a page of the verdicts and pictures that are there")
      ->type_name("FILE.md");
  figures_command->add_flag("--force", a.force, "run these figures anew");
  figures_command->add_flag("--dry-run", a.dry_run, "print the runs and about how long they take");

  CLI::App* measure_command =
      app.add_subcommand("measure", "figures of merit, fits and plots of a stored run or sweep");
  measure_command->add_option("folder", a.run, "folder of a run or of a sweep")
      ->required()
      ->type_name("RUN|STUDY")
      ->check(CLI::ExistingDirectory);
  const auto of_fields = [&](const char* name, auto& values, const char* type, const char* what) {
    return measure_command->add_option(name, values, what)->type_name(type)->allow_extra_args(false);
  };
  of_fields("--line", a.measure.lines, "X0,Y0,X1,Y1|x=X|y=Y",
            "profiles of fields along a line; may be repeated");
  of_fields("--probe", a.measure.probes, "X,Y", "fields at a place over time; may be repeated");
  of_fields("--field", a.measure.fields, "F",
            "field along lines and at probes; may be repeated (default: all that are stored)");
  of_fields(
      "--time", a.measure.times, "T",
      "lines at the frame nearest to this time; may be repeated (default: mean over the discharge's window)");
  of_fields("--threshold", a.measure.speeds, "S",
            "share of grains slower than S sqrt(g d); may be repeated (default: 1e-2, 1e-3 and 1e-4)")
      ->check(CLI::PositiveNumber);

  CLI::App* report_command =
      app.add_subcommand("report", "a run or a sweep on one HTML page that needs nothing else");
  report_command->add_option("folder", a.run, "folder of a run or of a sweep")
      ->required()
      ->type_name("RUN|STUDY")
      ->check(CLI::ExistingDirectory);
  report_command->add_option("--out", a.out, "file (default: report.html in the folder)")->type_name("FILE");

  CLI::App* fit_command =
      app.add_subcommand("fit", "B and Q of the kinematic model that comes nearest to a stored run");
  fit_command->add_option("run", a.run, "run folder")
      ->required()
      ->type_name("RUN")
      ->check(CLI::ExistingDirectory);
  fit_command
      ->add_option("--time", a.fit_time,
                   "fit to the frame nearest to this time (default: the first developed)")
      ->type_name("T");
  fit_command->add_option("--csv", a.csv, "write velocities of run and fit at ten heights: x, y, v, v_fit")
      ->type_name("FILE");

  CLI::App* render_command = app.add_subcommand("render", "draw pictures from a stored run");
  render_command->add_option("run", a.run, "run folder")
      ->required()
      ->type_name("RUN")
      ->check(CLI::ExistingDirectory);
  render_command
      ->add_option("--field", a.render.fields,
                   "field to draw; may be repeated (default: all that are stored)")
      ->type_name("F")
      ->allow_extra_args(false);
  render_command
      ->add_option("--time", a.render.times,
                   "draw the frame nearest to this time; may be repeated (default: all)")
      ->type_name("T")
      ->allow_extra_args(false);
  render_command
      ->add_option("--overlay", a.overlays,
                   "draw over the colours: quasi_static or streamlines; may be repeated")
      ->type_name("O")
      ->check(CLI::IsMember(std::vector<std::string>(overlay_names.begin(), overlay_names.end())))
      ->allow_extra_args(false);
  render_command->add_flag("--half", a.render.half,
                           "of a mirrored or axisymmetric domain draw only the half");
  render_command
      ->add_flag("--animate", a.render.animate,
                 "a video of each field, <field>.ogv, and its pictures, frames/")
      ->excludes("--time");

  // A reader that has gone and a limit on the size of files are errors like others, told where they happen.
  for (const int signal : {SIGPIPE, SIGXFSZ}) std::signal(signal, SIG_IGN);
  CLI::App* pages_command =
      app.add_subcommand("pages", "write the man page, the completions of shells and the reference of keys");
  pages_command->group("");  // for who packages hourglass
  pages_command->add_option("folder", a.out, "folder")->required()->check(CLI::ExistingDirectory);
  pages_command
      ->add_option("--page", a.page, "put the reference of keys between its markers in this page, too")
      ->check(CLI::ExistingFile);

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? finished : wrong_input;
  }
  if (*run_command) return run(a);
  if (*check_command) return check(a);
  if (*plan_command) return plan(a);
  if (*limits_command) return limits(a);
  if (*trade_command) return trade(a);
  if (*sweep_command) return sweep(a);
  if (*figures_command) return figures(a);
  if (*measure_command) return measure(a);
  if (*report_command) return report(a);
  if (*fit_command) return fit(a);
  if (*pages_command) return write_pages(app, a);
  return render(a);
} catch (const std::invalid_argument& error) {  // what was asked for cannot be: nothing was written
  tell(error.what());
  return wrong_input;
} catch (const std::bad_alloc&) {
  tell("out of memory");
  return failed;
} catch (const std::exception& error) {
  tell(error.what());
  return failed;
}
