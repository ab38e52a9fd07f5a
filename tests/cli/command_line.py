#!/usr/bin/env python3
"""Runs hourglass as a user would, on bad input above all: exit status, messages, and that nothing is written."""
import csv
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from xml.etree import ElementTree

PROGRAM = os.path.abspath(sys.argv.pop(1))

SCENE = {
    "name": "name: test",
    "domain": "domain: {width: 40, height: 40}",
    "grid": "grid: {cells_x: 16}",
    "materials": "materials: {sand: {mu_s: 0.32, delta_mu: 0.28, I_0: 0.4}}",
    "fill": "fill: [{material: sand, box: {x: [0, 40], y: [0, 30]}}]",
    "orifices": "orifices: [{wall: bottom, centre: 20, width: 20}]",
    "time": "time: {end: 1}",
    "output": "output: {fields_every: 0, snapshots_every: 0}",
}
LINE = {key: line for line, key in enumerate(SCENE, start=1)}


class CommandLine(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def scene(self, **changed):
        with open(self.path("scene.yaml"), "w") as file:
            file.write("".join(line + "\n" for line in {**SCENE, **changed}.values() if line))

    def hourglass(self, *arguments):
        return subprocess.run([PROGRAM, *arguments], cwd=self.folder.name, capture_output=True, text=True, timeout=120)

    def refuse(self, *arguments, says=()):
        """The arguments must end in exit status 2, the words on stderr, and no new file."""
        before = sorted(os.listdir(self.folder.name))
        result = self.hourglass(*arguments)
        self.assertEqual(result.returncode, 2, result.stdout + result.stderr)
        for words in says:
            self.assertIn(words, result.stderr)
        self.assertEqual(sorted(os.listdir(self.folder.name)), before)
        return result

    def test_help_and_version(self):
        for command in ([], ["run"], ["check"], ["plan"], ["limits"], ["render"], ["trade"], ["fit"], ["sweep"],
                        ["figures"], ["measure"], ["report"]):
            result = self.hourglass(*command, "--help")
            self.assertEqual(result.returncode, 0)
            self.assertIn("--help", result.stdout)
        result = self.hourglass("--version")
        self.assertEqual(result.returncode, 0)
        for word in ("hourglass", "0.1.0"):
            self.assertIn(word, result.stdout)

    def test_wrong_command_lines(self):
        self.scene()
        self.refuse()
        self.refuse("runn", "scene.yaml")
        self.refuse("run")
        self.refuse("run", "scene.yaml", "--frce", says=["--frce"])
        self.refuse("run", "scene.yaml", "--threads", "many")
        self.refuse("run", "scene.yaml", "--threads", "-1")
        self.refuse("run", "scene.yaml", "--resume", "--force", says=["--resume excludes --force"])
        self.refuse("render", "no_such_run")

    def test_wrong_scenes(self):
        self.refuse("run", "missing.yaml", says=["missing.yaml: no such file"])
        cases = [  # key, its line in the scene, what must be said
            ("domain", "domain: {width: 40", "not valid YAML"),
            ("domain", "domain: {width: wide, height: 40}", "domain.width: found the text 'wide' (expected a number)"),
            ("domain", "domain: {width: 0, height: 40}", "domain.width: 0 is out of range (must be > 0)"),
            ("domain", "domain: {width: 40, height: -40}", "domain.height: -40 is out of range (must be > 0)"),
            ("grid", "grid: {cells_x: 150}", "grid.cells_x: 150 x 150 cells can be halved only to 75 x 75"),
            ("grid", "grid: {cels_x: 16, cells_x: 16}", "grid.cels_x: unknown key. Did you mean 'cells_x'?"),
            ("materials", "materials: {}", "materials: there is no material"),
            ("materials", "materials: {sand: {mu_s: -0.1}}", "materials.sand.mu_s: -0.1 is out of range (must be >= 0)"),
            ("orifices", "orifices: [{wall: bottom, centre: 35, width: 20}]", "orifices.0.centre: the orifice reaches"),
            ("orifices", "orifices: [{wall: bottom, centre: 20, width: 2.5}]", "orifices.0.width: the neck is 1 cells"),
            ("time", "time: {cfl: 0.5}", "time: nothing ends this run"),
        ]
        for command in ("run", "check", "plan", "trade"):
            for key, line, words in cases:
                with self.subTest(command=command, line=line):
                    self.scene(**{key: line})
                    place = "" if "YAML" in words else f"scene.yaml:{LINE[key]} "
                    self.refuse(command, "scene.yaml", says=["scene.yaml:", place + words])

    def test_words_that_cannot_be_written(self):
        """The exit status tells then, and no file of a run gets them."""
        def status(command, streams):
            return subprocess.run(["sh", "-c", f'exec "$0" "$@" {streams}', PROGRAM, command, "scene.yaml", "--threads=1"],
                                  cwd=self.folder.name, timeout=120).returncode

        self.scene(name="nme: test")
        for streams in ("2>/dev/full", "2>&-", "<&- >&- 2>&-"):
            self.assertEqual(status("check", streams), 2, streams)
        self.scene(output="output: {fields_every: 1, snapshots_every: 0}")
        self.assertEqual(status("run", "<&- >&- 2>&-"), 0)
        for name, begins in {"series.csv": b"t,step", "fields.h5": b"\x89HDF", "run.log": b"20"}.items():
            with open(self.path(f"runs/test/{name}"), "rb") as file:
                self.assertTrue(file.read().startswith(begins), name)

    def test_all_errors_at_once(self):
        self.scene(domain="domain: {width: 0, height: 40}", time="time: {cfl: 2}", name="nme: test")
        result = self.refuse("run", "scene.yaml", "--set", "threads=-1", "--set", "foo=1",
                             says=["domain.width", "time.cfl", "nme: unknown key. Did you mean 'name'?",
                                   "time: nothing ends", "--set threads=-1 threads", "--set foo=1 foo"])
        self.assertEqual(len(result.stderr.splitlines()), 6)

    def test_wrong_overrides(self):
        self.scene()
        self.refuse("run", "scene.yaml", "--set", "time.endd=3", says=["--set time.endd=3 time.endd: unknown key"])
        self.refuse("run", "scene.yaml", "--set", "time.end", says=["--set time.end: expected path=value"])
        self.refuse("run", "scene.yaml", "--set", "fill.5.material=air", says=["fill is a list of 1"])

    def test_check(self):
        self.scene()
        result = self.hourglass("check", "scene.yaml", "--set", "orifices.0.width=10")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("warning: neck is 4 cells wide; use >= 8", result.stderr)
        self.assertIn("16 x 16 cells", result.stdout)
        self.assertIn("sand: well posed for", result.stdout)
        self.assertIn("One projection of noise", result.stdout)
        self.assertEqual(os.listdir(self.folder.name), ["scene.yaml"])

    def test_trade_tells_its_runs_and_writes_nothing(self):
        self.scene()
        result = self.hourglass("trade", "scene.yaml", "--dry-run")
        self.assertEqual(result.returncode, 0, result.stderr)
        for words in ("balanced", "grid.cells_x=32", "accuracy.viscous_tolerance=", "time.dt_max="):
            self.assertIn(words, result.stdout)
        self.assertEqual(os.listdir(self.folder.name), ["scene.yaml"])
        self.refuse("trade", "scene.yaml", "--budget", "-1")
        self.refuse("trade", "scene.yaml", "--set", "time={max_steps: 10}", says=["time.end"])

    def test_plan_tells_and_writes_nothing(self):
        self.scene(output="output: {fields_every: 0.5, snapshots_every: 0.5, fields: [speed, fluidity_ratio]}")
        before = os.stat(self.path("scene.yaml")).st_mtime_ns
        result = self.hourglass("plan", "scene.yaml", "--threads", "1", "--set", "physics.nonlocal.A=0.7",
                                "--set", "time.dt_max=0.01")
        self.assertEqual(result.returncode, 0, result.stderr)
        for words in ("Switched on\n", "physics.nonlocal", "A = 0.7", "Off, neither stored nor paid for",
                      "Well-posedness", "sand: well posed for", "Memory\n", "viscous solve", "fluidity", "total",
                      "Steps and seconds\n", "100 steps, most by dt_max, to t = 1 by time.end", "3 frames", "in all"):
            self.assertIn(words, result.stdout)
        self.assertEqual(os.listdir(self.folder.name), ["scene.yaml"])
        self.assertEqual(os.stat(self.path("scene.yaml")).st_mtime_ns, before)

    def test_models_in_closed_form(self):
        output = "output: {snapshots_every: 0}"
        self.scene(time="", output=output)
        for model in ("kinematic", "stochastic", "radial"):
            radial = ["--set", "radial={phi: 30, phi_w: 15, half_angle: 20}"] if model == "radial" else []
            chosen = ["--set", f"model={model}", *radial]
            with self.subTest(model=model):
                for command in ("check", "plan"):
                    result = self.hourglass(command, "scene.yaml", *chosen)
                    self.assertEqual(result.returncode, 0, result.stderr)
                    self.assertIn(f"Model {model}", result.stdout)
                    self.assertNotIn("projection of noise", result.stdout)
                result = self.hourglass("run", "scene.yaml", "--out", model, *chosen)
                self.assertEqual(result.returncode, 0, result.stderr)
                with open(self.path(f"{model}/summary.json")) as file:
                    summary = json.load(file)
                self.assertEqual((summary["model"], summary["status"], summary["steps"]), (model, "finished", 0))
                self.assertAlmostEqual(summary["discharge_constant"], 1, 12)
                for name in ("scene.yaml", "run.log", "series.csv", "fields.h5", "fields.xdmf"):
                    self.assertGreater(os.path.getsize(self.path(f"{model}/{name}")), 0)
                again = self.hourglass("run", f"{model}/scene.yaml", "--out", model + "_again")
                self.assertEqual(again.returncode, 0, again.stderr)
                result = self.hourglass("render", model, "--field", "speed")
                self.assertEqual(result.returncode, 0, result.stderr)
        self.refuse("run", "scene.yaml", "--set", "model=kinematic", "--set",
                    "inserts=[{shape: circle, centre: [20, 15], diameter: 8}]",
                    says=["inserts: model kinematic cannot have solids"])
        self.refuse("run", "scene.yaml", "--set", "model=radial", "--set", "domain.coordinates=axisymmetric",
                    "--set", "orifices.0.centre=0", "--set", "materials.sand.mu_s=0.62",
                    says=["radial.half_angle: 51.6839 degrees is beyond the mass-flow limit"])

    def test_fit(self):
        self.scene(time="", output="output: {snapshots_every: 0}")
        result = self.hourglass("run", "scene.yaml", "--out", "run", "--set", "model=kinematic", "--set", "kinematic.B=3",
                                "--set", "kinematic.Q=50")
        self.assertEqual(result.returncode, 0, result.stderr)
        result = self.hourglass("fit", "run", "--csv", "fit.csv")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("B = 3, Q = 50,", result.stdout)
        with open(self.path("fit.csv")) as file:
            rows = file.read().splitlines()
        self.assertEqual(rows[0], "x,y,v,v_fit")
        for row in rows[1:]:
            _, _, v, v_fit = map(float, row.split(","))
            self.assertAlmostEqual(v, v_fit, 5)
        self.refuse("fit", "run", "--time", "7", says=["time 7 is outside the run"])
        self.refuse("fit", "no_such_run")

    def test_limits_needs_friction(self):
        self.scene(materials="materials: {water: {viscosity: 10}}", physics="physics: {rheology: {law: newtonian}}")
        self.refuse("limits", "scene.yaml", "--set", "fill.0.material=water", says=["law newtonian has no friction"])

    def test_run_once_and_only_once(self):
        self.scene()
        result = self.hourglass("run", "scene.yaml", "--quiet", "--threads", "1", "--set", "time.max_steps=3")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stdout, "")
        folder = self.path("runs/test")
        with open(os.path.join(folder, "summary.json")) as file:
            summary = json.load(file)
        self.assertEqual(summary["status"], "finished")
        self.assertEqual(summary["steps"], 3)
        self.assertEqual(summary["threads"], 1)

        written = {name: os.stat(os.path.join(folder, name)).st_mtime_ns for name in os.listdir(folder)}
        result = self.hourglass("run", "scene.yaml", "--set", "time.max_steps=2")
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn("--force", result.stderr)
        self.assertEqual(written, {n: os.stat(os.path.join(folder, n)).st_mtime_ns for n in os.listdir(folder)})

        result = self.hourglass("run", "scene.yaml", "--force", "--quiet", "--set", "time.max_steps=2")
        self.assertEqual(result.returncode, 0, result.stderr)
        result = self.hourglass("run", "runs/test/scene.yaml", "--out", "again", "--quiet")  # runs as it is
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(self.path("again/scene.yaml")) as again, open(os.path.join(folder, "scene.yaml")) as first:
            self.assertEqual(again.read(), first.read())

    def test_render(self):
        self.scene()
        result = self.hourglass("run", "scene.yaml", "--quiet", "--out", "run", "--set", "time.end=0.2", "--set",
                                "output={fields_every: 0.1, snapshots_every: 0, fields: [speed]}")
        self.assertEqual(result.returncode, 0, result.stderr)
        result = self.hourglass("render", "run", "--field", "speed", "--time", "0.1", "--overlay", "quasi_static",
                                "--overlay", "streamlines")
        self.assertEqual((result.returncode, result.stdout), (0, "run/pictures/speed_0001.png\n"), result.stderr)
        result = self.hourglass("render", "run", "--field", "speed", "--animate", "--half")
        self.assertEqual(result.returncode, 0, result.stderr)
        *files, line = result.stdout.splitlines()
        self.assertEqual(files, [f"run/frames/speed_{k:04}.png" for k in range(3)] + ["run/speed.ogv"])
        for file in files:
            self.assertGreater(os.path.getsize(self.path(file)), 1000)
        self.assertIn("ffmpeg -framerate 10 -i 'run/frames/speed_%04d.png'", line)

        self.refuse("render", "run", "--overlay", "streamline", says=["--overlay: streamline not in"])
        self.refuse("render", "run", "--animate", "--time", "0", says=["--time excludes --animate"])
        self.refuse("render", "run", "--field", "pressure", says=["'pressure' is not stored; stored are: grains, speed"])

    def test_signals_leave_a_complete_run(self):
        for number, status in ((signal.SIGINT, 130), (signal.SIGTERM, 143)):
            with self.subTest(signal=number):
                self.scene(time="time: {end: 1e6}")
                out = self.path(f"run_{status}")
                process = subprocess.Popen([PROGRAM, "run", "scene.yaml", "--out", out, "--quiet"],
                                           cwd=self.folder.name, stderr=subprocess.PIPE)
                series = os.path.join(out, "series.csv")
                for _ in range(600):
                    if os.path.exists(series) and os.path.getsize(series) > 600:
                        break
                    time.sleep(0.1)
                process.send_signal(number)
                stderr = process.communicate(timeout=60)[1]
                self.assertEqual(process.returncode, status, stderr)
                with open(os.path.join(out, "summary.json")) as file:
                    summary = json.load(file)
                self.assertEqual(summary["status"], "interrupted")

                steps = ["--set", f"time.max_steps={summary['steps'] + 20}"]
                self.refuse("run", "scene.yaml", "--out", out, says=["--resume"])
                self.refuse("run", "scene.yaml", "--out", out, "--resume", "--set", "materials.sand.mu_s=0.4",
                            says=["materials.sand.mu_s is 0.32 there, 0.4 here"])
                result = self.hourglass("run", "scene.yaml", "--out", out, "--resume", *steps)
                self.assertEqual(result.returncode, 0, result.stderr)
                self.assertIn("resumed at t = ", result.stdout)
                result = self.hourglass("run", "scene.yaml", "--out", "whole", "--force", *steps)
                self.assertEqual(result.returncode, 0, result.stderr)
                self.assertEqual(self.series(out), self.series("whole"))
                result = self.hourglass("run", "scene.yaml", "--out", out, "--resume", *steps)
                self.assertEqual(result.returncode, 0, result.stderr)
                self.assertIn("is at its end (finished)", result.stderr)

    def series(self, run):
        with open(os.path.join(self.path(run), "series.csv")) as file:
            rows = list(csv.DictReader(file))
        for row in rows:
            del row["wall_seconds"]
        return rows

    def test_extrapolation(self):
        self.scene()
        sets = ["--set", "grid.cells_x=32", "--set", "accuracy.extrapolate=1"]
        result = self.hourglass("run", "scene.yaml", *sets, "--out", "run")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("extrapolation: 16 x 16", result.stdout)
        self.assertIn("extrapolated from 2 grids", result.stdout)
        with open(self.path("run/summary.json")) as file:
            summary = json.load(file)
        told = summary["extrapolation"]
        self.assertEqual(told["cells"], [256, 1024])
        self.assertEqual(len(told["discharge_rates"]), 2)
        self.assertAlmostEqual(told["discharge_rates"][1], summary["discharge_rate"], places=9)
        self.assertEqual(told["order"], 1.5)
        self.refuse("run", "scene.yaml", "--set", "accuracy.extrapolate=2", says=["accuracy.extrapolate: 2 needs the scene on"])

        process = subprocess.Popen([PROGRAM, "run", "scene.yaml", *sets, "--set", "time.end=1e6", "--out", "long"],
                                   cwd=self.folder.name, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        process.stdout.readline()  # a coarser grid is on its way
        process.send_signal(signal.SIGINT)
        stderr = process.communicate(timeout=60)[1]
        self.assertEqual(process.returncode, 130, stderr)
        with open(self.path("long/summary.json")) as file:
            summary = json.load(file)
        self.assertEqual(summary["status"], "interrupted")
        self.assertIn("on a coarser grid", summary["reason"])

    def test_start_from_a_stored_run(self):
        self.scene(output="output: {fields_every: 0.5, snapshots_every: 0, fields: [pressure]}")
        self.assertEqual(self.hourglass("run", "scene.yaml", "--out", "first", "--quiet").returncode, 0)
        self.scene(fill="start: {run: first}", grid="")
        result = self.hourglass("run", "scene.yaml", "--out", "second", "--set", "accuracy=fast")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("grid.cells_x: 16 chosen by accuracy", result.stderr)
        again = self.hourglass("check", "second/scene.yaml")
        self.assertEqual(again.returncode, 0, again.stderr)
        self.refuse("run", "scene.yaml", "--set", "start.run=nowhere", says=["start: nowhere/fields.h5"])
        self.refuse("run", "scene.yaml", "--set", "domain.height=20", says=["the domain must be the same"])

    def study(self, *lines):
        with open(self.path("study.yaml"), "w") as file:
            file.write("\n".join(["name: widths", "scene: scene.yaml", *lines]) + "\n")

    def table(self, folder="sweeps/widths"):
        with open(self.path(f"{folder}/results.csv")) as file:
            return list(csv.DictReader(file))

    def without_times(self, rows):
        return [{key: value for key, value in row.items() if key != "wall_seconds"} for row in rows]

    def test_sweep_and_measure(self):
        self.scene()
        self.study("axes:", "  orifices.0.width: [10, 15, 20, 30]", "  mu: [0.32, 0.4]",
                   "set: {materials.sand.mu_s: mu}")
        result = self.hourglass("sweep", "study.yaml", "--dry-run")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("0008 orifices.0.width=30 mu=0.4: 16 x 16 cells", result.stdout)
        self.assertIn("8 runs, about", result.stdout)
        self.assertEqual(sorted(os.listdir(self.folder.name)), ["scene.yaml", "study.yaml"])

        result = self.hourglass("sweep", "study.yaml", "--jobs", "2", "--executor", "local")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("[8/8] ", result.stdout)
        rows = self.table()
        self.assertEqual([row["run"] for row in rows], [f"{k:04}" for k in range(1, 9)])
        self.assertEqual(list(rows[0])[:4], ["run", "orifices.0.width", "mu", "status"])
        for row in rows:
            with open(self.path(f"sweeps/widths/runs/{row['run']}/summary.json")) as file:
                summary = json.load(file)
            self.assertEqual(row["quasi_static_above_flat_top"], "")
            for name in ("discharge_rate", "discharge_constant", "quasi_static_fraction", "quasi_static_1e-2",
                         "quasi_static_1e-4", "mass_error", "steps", "cells",
                         "back_offs", "missed_tolerances", "wall_seconds"):
                self.assertEqual(float(row[name]), summary[name])
            self.assertEqual((row["status"], summary["threads"]), ("finished", 1))
        single = self.hourglass("run", "scene.yaml", "--threads", "1", "--set", "orifices.0.width=15", "--set",
                                "materials.sand.mu_s=0.4", "--out", "single")
        self.assertEqual(single.returncode, 0, single.stderr)
        with open(self.path("single/summary.json")) as file:
            self.assertEqual(float(rows[3]["discharge_rate"]), json.load(file)["discharge_rate"])

        again = self.hourglass("sweep", "study.yaml", "--resume")
        self.assertEqual((again.returncode, self.table()), (0, rows), again.stderr)

        result = self.hourglass("measure", "sweeps/widths")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("mu = 0.32, k free: C = ", result.stdout)
        with open(self.path("sweeps/widths/fit.csv")) as file:
            fits = list(csv.DictReader(file))
        self.assertEqual([(fit["runs"], fit["fit"]) for fit in fits],
                         [(f"mu = {mu}", name) for mu in (0.32, 0.4)
                          for name in ("k free", "k = 0", "k and n free", "n free, k = 0")])
        with open(self.path("sweeps/widths/curves.csv")) as file:
            self.assertEqual(len(list(csv.DictReader(file))), 8)
        for name in ("discharge_rate", "normalised", "beverloo"):
            self.assertGreater(os.path.getsize(self.path(f"sweeps/widths/plots/{name}.png")), 1000)

    def test_a_figure_to_its_verdicts_and_its_page(self):
        figures = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../configs/figures")
        result = self.hourglass("figures", os.path.join(figures, "4_02_radial.yaml"))
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        with open(self.path("figures/verdicts.csv")) as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([row["verdict"] for row in rows], ["pass", "pass", "pass", "differs"])
        self.assertEqual(rows[0]["measured"], "0.7441")
        again = self.hourglass("figures", os.path.join(figures, "4_02_radial.yaml"))
        self.assertNotIn("[1/1]", again.stdout)
        page = self.hourglass("figures", figures, "--page", "page.md")
        self.assertEqual(page.returncode, 0, page.stderr)
        with open(self.path("page.md")) as file:
            text = file.read()
        self.assertIn("| quick | 4 | 3 | 1 | 0 |", text)
        self.assertGreater(os.path.getsize(self.path("page/4_02_radial_error.png")), 1000)
        self.refuse("figures", "nowhere", says=["nowhere"])

    def test_measure_of_a_run(self):
        self.scene(materials="materials: {sand: {mu_s: 0.32, delta_mu: 0.28, I_0: 0.4}, tracer: {mu_s: 0.32, "
                             "delta_mu: 0.28, I_0: 0.4}}",
                   fill="fill: [{material: sand, box: {x: [0, 40], y: [0, 30]}}, "
                        "{material: tracer, box: {x: [0, 40], y: [10, 30]}}]",
                   time="time: {end: 12}",
                   output="output: {fields_every: 2, snapshots_every: 0, fields: [speed]}")
        result = self.hourglass("run", "scene.yaml", "--quiet", "--out", "run")
        self.assertEqual(result.returncode, 0, result.stderr)
        result = self.hourglass("measure", "run")
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(self.path("run/measure.csv")) as file:
            measured = {row["quantity"]: row for row in csv.DictReader(file)}
        self.assertEqual(list(measured), ["discharge_rate", "discharge_constant", "tracer_mean_residence_time",
                                          "tracer_residence_time_variance", "tracer_mixing_index",
                                          "quasi_static_1e-2", "quasi_static_1e-3", "quasi_static_1e-4"])
        with open(self.path("run/summary.json")) as file:
            summary = json.load(file)
        rate = measured["discharge_rate"]
        self.assertAlmostEqual(float(rate["value"]) / summary["discharge_rate"], 1, 2)
        self.assertGreater(float(rate["standard_error"]), 0)
        self.assertEqual(float(rate["from"]), summary["discharge_window"][0])
        self.assertLess(0, float(measured["tracer_mean_residence_time"]["value"]))
        with open(self.path("run/step_change.csv")) as file:
            shares = [float(row["tracer_F"]) for row in csv.DictReader(file)]
        self.assertLess(shares[0], 0.01)
        self.assertGreater(max(shares), 0.5)
        self.assertEqual(sorted(os.listdir(self.path("run/plots"))),
                         ["discharge.png", "quasi_static.png", "residence_time.png", "step_change.png", "step_change_drained.png"])
        result = self.hourglass("measure", "run", "--line", "x=20", "--line", "10,5,30,5", "--field", "speed",
                                "--time", "12", "--probe", "20,5", "--threshold", "5e-3")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("quasi_static_0.005: ", result.stdout)
        with open(self.path("run/profiles.csv")) as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(list(rows[0]), ["line", "t", "s", "x", "y", "speed"])
        self.assertEqual({row["line"] for row in rows}, {"1", "2"})
        with open(self.path("run/probes.csv")) as file:
            self.assertGreater(float(list(csv.DictReader(file))[1]["speed"]), 0)
        self.refuse("measure", "run", "--line", "x=50", says=["--line x=50: (50, 0) lies outside of the silo"])
        self.refuse("measure", "run", "--threshold", "0", says=["--threshold"])
        again = self.hourglass("run", "scene.yaml", "--quiet", "--out", "run", "--force", "--set", "time.end=1")
        self.assertEqual(again.returncode, 0, again.stderr)
        os.mkdir(self.path("empty"))
        self.refuse("measure", "empty", says=["empty: holds neither a run (series.csv) nor a sweep (results.csv)"])
        self.refuse("measure", "nowhere")

    def test_wrong_studies(self):
        self.scene()
        self.refuse("sweep", "missing.yaml", says=["missing.yaml: no such file"])
        self.study("axes: {gap: [1, 2]}", "set: {time.edn: gap}")
        self.refuse("sweep", "study.yaml", says=["study.yaml:4 time.edn: unknown key. Did you mean 'end'? (all runs)"])
        self.study("axes: {time.end: [1, 2]}", "sets: {}")
        self.refuse("sweep", "study.yaml", says=["study.yaml:4 sets: unknown key", "Did you mean 'set'?"])
        self.study("axes: {time.end: [1, -2]}")
        self.refuse("sweep", "study.yaml", says=["study.yaml:3 time.end: -2", "(run 0002: time.end=-2)"])
        self.refuse("sweep", "study.yaml", "--jobs", "0")
        self.refuse("sweep", "study.yaml", "--executor", "cloud", says=["--executor"])
        self.study("axes: {time.end: [1, 2]}")
        path = os.environ["PATH"]
        try:
            os.environ["PATH"] = "/nowhere"
            self.refuse("sweep", "study.yaml", "--executor", "slurm", says=["--executor slurm: there is no sbatch here"])
        finally:
            os.environ["PATH"] = path
        with open(self.path("study.yaml"), "w") as file:
            file.write("scene: nowhere.yaml\naxes: {time.end: [1, 2]}\n")
        self.refuse("sweep", "study.yaml", says=["nowhere.yaml: no such file"])

    def test_a_sweep_goes_on_after_it_was_killed(self):
        self.scene()
        self.study("axes: {orifices.0.width: [15, 20, 30], time.end: [20, 21, 22]}", "set: {time.dt_max: '0.005'}")
        whole = self.hourglass("sweep", "study.yaml", "--out", "whole")
        self.assertEqual(whole.returncode, 0, whole.stderr)
        command = [PROGRAM, "sweep", "study.yaml", "--out", "cut", "--jobs", "2"]
        for number, status in ((signal.SIGKILL, -9), (signal.SIGTERM, 143), (signal.SIGKILL, -9)):
            process = subprocess.Popen(command, cwd=self.folder.name, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            process.stdout.readline()  # a run has ended, others are on their way
            process.send_signal(number)
            process.communicate(timeout=60)
            self.assertEqual(process.returncode, status)
            self.assertLess(len(self.table("cut")), 9)
            self.assertGreater(len(self.table("cut")), 0)
        result = subprocess.run(command, cwd=self.folder.name, capture_output=True, text=True, timeout=120)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(self.without_times(self.table("cut")), self.without_times(self.table("whole")))

    def small_disk(self):
        """A folder on a disk of 2 MiB, which takes root."""
        disk = self.path("disk")
        os.mkdir(disk)
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=2m", "none", disk], capture_output=True).returncode:
            self.skipTest("may not mount a small disk here")
        self.addCleanup(subprocess.run, ["umount", "--lazy", disk])
        return disk

    def test_a_full_disk_leaves_a_whole_run_with_a_summary(self):
        disk = self.small_disk()
        ballast, out = os.path.join(disk, "ballast"), os.path.join(disk, "run")
        self.scene(time="time: {end: 1e6}")
        cases = [  # what fills the disk, of which so much is taken
            ("fields[.]", "{fields_every: 0.01, snapshots_every: 0}", 1_000_000),
            ("series[.]csv", "{series_every: 0.01, fields_every: 0, snapshots_every: 0}", 1_900_000),
            ("speed_", "{fields_every: 0, snapshots_every: 0.01, fields: [speed]}", 1_000_000),
        ]
        for culprit, output, taken in cases:
            with self.subTest(culprit=culprit):
                shutil.rmtree(out, ignore_errors=True)
                with open(ballast, "wb") as file:
                    file.write(bytes(taken))
                result = self.hourglass("run", "scene.yaml", "--out", out, "--quiet", "--set", f"output={output}")
                self.assertEqual(result.returncode, 1, result.stderr)
                cause = result.stderr.rstrip("\n")
                self.assertRegex(cause, f"^[^\n]*{culprit}[^\n]*: No space left on device$")
                with open(os.path.join(out, "summary.json")) as file:
                    summary = json.load(file)
                self.assertEqual((summary["status"], summary["reason"]), ("interrupted", cause))
                self.assertGreater(summary["steps"], 0)
                with open(os.path.join(out, "series.csv")) as file:
                    series = file.read()
                self.assertTrue(series.endswith("\n"))
                self.assertEqual(len({line.count(",") for line in series.splitlines()}), 1)
                self.assertFalse([name for _, _, names in os.walk(out) for name in names if name.endswith(".new")])
                os.remove(ballast)
                if culprit == "fields[.]":  # whose frames can be read
                    frames = ElementTree.parse(os.path.join(out, "fields.xdmf")).findall(".//Time")
                    self.assertGreater(len(frames), 1)
                    result = self.hourglass("render", out, "--field", "speed", "--time", frames[-1].get("Value"))
                    self.assertEqual(result.returncode, 0, result.stderr)


if __name__ == "__main__":
    unittest.main()
