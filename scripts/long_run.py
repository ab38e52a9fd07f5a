#!/usr/bin/python3
"""A long run with everything on: does its memory stay flat, its mass stay, its tolerances hold?

    scripts/long_run.py PROGRAM [--out DIR] [--cells 512] [--steps 20000] [--threads 2]

configs/silo_everything.yaml, fed so that it never drains. Writes DIR/memory.csv while it goes on and DIR/long_run.md at its end, the
table of docs/reliability.md. Exit status 1 if the run ended in another way than at its last step.
"""
import argparse
import csv
import json
import pathlib
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
SETS = ["time.end=0", "stop=", "feed={material: tracer, level: 135}", "output.fields_every=20", "output.snapshots_every=20",
        "output.compression=1"]


def resident(pid):
    """MB of memory that a process has, or None if it is gone."""
    try:
        with open(f"/proc/{pid}/status") as file:
            return next((int(line.split()[1]) / 1024 for line in file if line.startswith("VmRSS")), None)
    except FileNotFoundError:
        return None


def run(options):
    command = [options.program, "run", ROOT / "configs/silo_everything.yaml", "--out", options.out, "--quiet", "--threads",
               str(options.threads), "--set", f"grid.cells_x={options.cells}", "--set", f"time.max_steps={options.steps}"]
    for key in SETS:
        command += ["--set", key]
    process = subprocess.Popen(command)
    began = time.time()
    while not (options.out / "series.csv").exists() and process.poll() is None:
        time.sleep(1)
    with open(options.out / "memory.csv", "w") as file:
        file.write("wall_seconds,resident_MB\n")
        while process.poll() is None:
            if (memory := resident(process.pid)) is not None:
                file.write(f"{time.time() - began:.0f},{memory:.1f}\n")
                file.flush()
            time.sleep(10)
    return process.returncode


def table(out):
    rows = list(csv.DictReader(open(out / "series.csv")))
    memory = [(float(row["wall_seconds"]), float(row["resident_MB"])) for row in csv.DictReader(open(out / "memory.csv"))]
    filled = float(rows[0]["mass"])
    times = [float(row["t"]) for row in rows]
    fed = sum((b - a) * float(row["fed"]) for a, b, row in zip(times, times[1:], rows[1:]))
    summary = json.loads((out / "summary.json").read_text())
    lines = ["| step | t | wall time | resident memory | outflow | iterations: pressure, viscous, fluidity |", "|---|---|---|---|---|---|"]
    last = int(rows[-1]["step"])
    for tenth in range(1, 11):
        row = next(row for row in rows if int(row["step"]) >= last * tenth // 10)
        wall = float(row["wall_seconds"])
        megabytes = [m for seconds, m in memory if seconds <= wall + 15]
        lines.append(f"| {row['step']} | {float(row['t']):.1f} | {wall:.0f} s | {megabytes[-1]:.0f} MB | {float(row['outflow']):.1f} | "
                     f"{row['iterations_pressure']}, {row['iterations_viscous']}, {row['iterations_fluidity']} |")
    lines.append("")
    lines.append(f"{summary['steps']} steps on {summary['cells']} cells, {summary['status']}; grains of mass {fed:.0f} "
                 f"were fed to {filled:.0f}; mass error {summary['mass_error']:.1e}; missed tolerances {summary['missed_tolerances']}; "
                 f"back-offs {summary['back_offs']}; warnings {len(summary['warnings'])}; peak memory "
                 f"{summary['peak_memory_bytes'] / 2**20:.0f} MB.")
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("runs/long_run"))
    parser.add_argument("--cells", type=int, default=512)
    parser.add_argument("--steps", type=int, default=20000)
    parser.add_argument("--threads", type=int, default=2)
    options = parser.parse_args()
    status = run(options)
    if status == 0:
        (options.out / "long_run.md").write_text(table(options.out))
        print((options.out / "long_run.md").read_text())
    return 1 if status else 0


if __name__ == "__main__":
    sys.exit(main())
