#!/usr/bin/python3
"""What the words of `accuracy` cost and buy, scene by scene, against a reference of the scene's own: docs/trade.md.

    scripts/presets.py [--hourglass PATH] [--out DIR] [--only SCENE]

Each word runs with the grid that it chooses. The reference is a Richardson extrapolation from 128, 256 and 512 cells across at the
tolerances of `accurate` with half the longest step. Runs that are there already are not repeated. Writes
presets.csv and presets.md, the table of docs/trade.md.
"""
import argparse
import bisect
import csv
import json
import pathlib
import resource
import subprocess

import h5py
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent
END = 30
ENDS = {"layers_friction": 45}  # its tracer is to leave
SCENES = {
    "silo": ("configs/silo.yaml", []),
    "two_orifices": ("configs/two_orifices.yaml", []),
    "diamond_nonlocal": ("configs/inserts/diamond.yaml", ["physics.nonlocal.A=0.5", "orifices.0.width=18.75"]),
    "layers_friction": ("configs/layers_friction.yaml", []),
    "uneven_orifices": ("configs/uneven_orifices.yaml", []),  # not used in choosing the words
}
COMMON = ["stop={}", "output.fields_every=5", "output.fields=[pressure]", "output.snapshots_every=0", "output.series_every=0.25"]
RUNS = {
    "reference": ["accuracy=accurate", "grid.cells_x=512", "time.dt_max=0.0274"],
    "fast": ["accuracy=fast", "grid.cells_x=auto"],
    "balanced": ["accuracy=balanced", "grid.cells_x=auto"],
    "accurate": ["accuracy=accurate", "grid.cells_x=auto"],
}


def run(program, scene, sets, folder, threads):
    """summary.json of the run, with processor seconds; from the folder if it is there."""
    done = folder / "presets_run.json"
    if not done.exists():
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        command = [program, "run", ROOT / scene, "--quiet", "--force", "--threads", str(threads), "--out", folder]
        for s in COMMON + sets:
            command += ["--set", s]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        summary = json.loads((folder / "summary.json").read_text())
        summary["cpu_seconds"] = after.ru_utime - before.ru_utime
        done.write_text(json.dumps(summary))
    return json.loads(done.read_text())


def tracer_curve(folder):
    """Share of what is not the first material in all that has left, at forty times; empty with one material."""
    with open(folder / "series.csv") as file:
        rows = list(csv.DictReader(file))
    names = [c[:-len("_outflow")] for c in rows[0] if c.endswith("_outflow")]
    if len(names) < 2:
        return []
    times, gone, others = [], [], []
    total = other = last = 0.0
    for row in rows:
        t = float(row["t"])
        flows = [float(row[n + "_outflow"]) for n in names]
        total += sum(flows) * (t - last)
        other += sum(flows[1:]) * (t - last)
        last = t
        times.append(t), gone.append(total), others.append(other)
    curve = []
    for k in range(1, 41):
        at = min(bisect.bisect_left(times, k * times[-1] / 40), len(times) - 1)
        curve.append(others[at] / gone[at] if gone[at] > 0 else 0.0)
    return curve


def at_points(values, spacing, x, y):
    """Of cells, bilinear between their middles."""
    i, j = np.clip(x / spacing - 0.5, 0, values.shape[1] - 1.001), np.clip(y / spacing - 0.5, 0, values.shape[0] - 1.001)
    i0, j0 = i.astype(int), j.astype(int)
    a, b = i - i0, j - j0
    return ((1 - a) * (1 - b) * values[j0, i0] + a * (1 - b) * values[j0, i0 + 1]
            + (1 - a) * b * values[j0 + 1, i0] + a * b * values[j0 + 1, i0 + 1])


def picture_of(folder):
    """What fields are compared by, at places that do not depend on the grid: mean developed pressure at probes, velocity in the
    middle of the developed time, height of the surface at the end."""
    with h5py.File(folder / "fields.h5") as file:
        spacing, width = file.attrs["spacing"], file.attrs["spacing"] * file.attrs["cells"][0]
        orifices = file.attrs["orifices"]
        frames = list(file["frames"].values())
        developed = [f for f in frames if f.attrs["time"] > 10]
        probes = [(width / 4, 45.0), (3 * width / 4, 45.0), (width / 4, 90.0)] + [(c, 2 * w) for _, c, w in orifices]
        x, y = np.array(probes).T
        pressure = np.mean([at_points(f["pressure"][:], spacing, x, y) for f in developed], axis=0)
        middle = developed[len(developed) // 2]
        gx, gy = np.meshgrid((np.arange(64) + 0.5) * width / 64, (np.arange(64) + 0.5) * width / 64)
        share = at_points(middle["grains"][:], spacing, gx, gy)
        velocity = [np.where(share > 0.5, at_points(middle["velocity"][:, :, k], spacing, gx, gy), 0) for k in (0, 1)]
        columns = frames[-1]["grains"][:].sum(axis=0) * spacing
        surface = np.interp((np.arange(64) + 0.5) * width / 64, (np.arange(columns.size) + 0.5) * spacing, columns)
        return {"pressure": pressure, "velocity": np.stack(velocity), "surface": surface / width}


def field_errors(folder, reference):
    if folder == reference:
        return {"pressure_error": "", "velocity_error": "", "surface_error": ""}
    a, b = picture_of(folder), picture_of(reference)
    relative = {k: np.linalg.norm(a[k] - b[k]) / np.linalg.norm(b[k]) for k in ("pressure", "velocity")}
    return {"pressure_error": f"{relative['pressure']:.1e}", "velocity_error": f"{relative['velocity']:.1e}",
            "surface_error": f"{np.mean(abs(a['surface'] - b['surface'])):.1e}"}


def rate_and_share(summary):
    limit = summary.get("extrapolation") or summary
    return limit["discharge_rate"], limit["quasi_static_fraction"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--hourglass", default=ROOT / "hourglass")
    parser.add_argument("--out", default="presets", type=pathlib.Path)
    parser.add_argument("--only", choices=SCENES)
    parser.add_argument("--threads", type=int, default=1)
    a = parser.parse_args()
    a.out.mkdir(parents=True, exist_ok=True)
    rows = []
    for name, (scene, own) in SCENES.items():
        if a.only and name != a.only:
            continue
        own = own + [f"time.end={ENDS.get(name, END)}"]
        results = {word: run(a.hourglass, scene, own + sets, a.out / f"{name}_{word}", a.threads)
                   for word, sets in RUNS.items()}
        rate, share = rate_and_share(results["reference"])
        curve = tracer_curve(a.out / f"{name}_reference")
        limit = results["reference"]["extrapolation"]
        for word, summary in results.items():
            q, s = rate_and_share(summary)
            there = tracer_curve(a.out / f"{name}_{word}")
            rows.append({
                "scene": name, "accuracy": word, "cells": summary["cells"], "steps": summary["steps"],
                "cpu_seconds": round(summary["cpu_seconds"], 2),
                "discharge_rate": f"{q:.5g}",
                "discharge_error": f"{limit['error_bar'] / rate if word == 'reference' else q / rate - 1:+.2e}",
                "quasi_static_fraction": f"{s:.4f}",
                "quasi_static_error": f"{limit['quasi_static_error_bar'] if word == 'reference' else s - share:+.1e}",
                "tracer_error": f"{sum(abs(x - y) for x, y in zip(there, curve)) / len(curve):.1e}" if curve else "",
                **field_errors(a.out / f"{name}_{word}", a.out / f"{name}_reference"),
                "mass_error": f"{summary['mass_error']:.1e}",
                "missed_tolerances": summary["missed_tolerances"], "back_offs": summary["back_offs"],
            })
            print(*rows[-1].values(), sep="\t", flush=True)
    if a.only:
        return
    with open(a.out / "presets.csv", "w", newline="") as file:
        table = csv.DictWriter(file, rows[0], lineterminator="\n")
        table.writeheader()
        table.writerows(rows)
    lines = ["| scene | accuracy | cells | processor s | discharge rate | error | quasi-static share | difference | pressure | surface | velocity | tracer | mass |",
             "|---|---|---|---|---|---|---|---|---|---|---|---|---|"]
    for r in rows:
        bar = "± " if r["accuracy"] == "reference" else ""
        percent = [f"{bar}{100 * abs(float(r[k])):.2g} %" if bar else f"{100 * float(r[k]):+.2g} %"
                   for k in ("discharge_error", "quasi_static_error")]
        lines.append(f"| {r['scene']} | {r['accuracy']} | {round(int(r['cells']) ** 0.5)}² | {r['cpu_seconds']:.3g} "
                     f"| {r['discharge_rate']} | {percent[0]} | {r['quasi_static_fraction']} | {percent[1]} "
                     + "".join(f"| {100 * float(r[k]):.2g} % " if r[k] else "| " for k in
                               ("pressure_error", "surface_error", "velocity_error", "tracer_error"))
                     + f"| {r['mass_error']} |")
    (a.out / "presets.md").write_text("\n".join(lines) + "\n")
    print(a.out / "presets.md")


if __name__ == "__main__":
    main()
