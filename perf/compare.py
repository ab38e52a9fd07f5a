#!/usr/bin/env python3
"""What moved between two runs of a benchmark program: compare.py OLD.json NEW.json [--band PER_CENT]

The files come from --benchmark_format=json. Shown are ratios (to the plain twin, to the triad of the same run, two
threads to one), which tell of the code; rates, which tell of the machine as well, with --rates; and what is counted
(iterations, allocations) when it changed at all."""
import argparse
import json

RATIOS = ("x_plain", "%roof", "speedup_2")
RATES = ("cells/s", "triad_GB/s")
COUNTS = ("its", "allocs/step", "viscous_its", "pressure_its", "B/cell")
BY_THE_WAY = ("cells/s_2", "%roof_2", "of_one_thread", "later", "developed", "developed_raw",
              "start", "start_raw", "empty", "empty_raw")


def read(text):
    """{case: {counter: value}} of Google Benchmark's JSON."""
    cases = {}
    for run in json.loads(text)["benchmarks"]:
        name = run["name"].removesuffix("/manual_time").removesuffix("/iterations:1")
        cases[name] = {key: value for key, value in run.items() if key in RATIOS + RATES + COUNTS + BY_THE_WAY}
    return cases


def moved(old, new, keys, band):
    """(case, counter, old, new) of the cases in both, where new / old is off 1 by more than the band."""
    for case in old:
        for key in keys:
            a, b = (cases.get(case, {}).get(key) for cases in (old, new))
            if a is not None and b is not None and abs(b - a) > band * abs(a):
                yield case, key, a, b


def line(case, key, a, b):
    change = f"{100 * (b / a - 1):+.1f} %" if a else ""
    return f"{case:34} {key:12} {a:11.4g} -> {b:11.4g}  {change}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old")
    parser.add_argument("new")
    parser.add_argument("--band", type=float, default=10, help="changes within so many per cent are noise (10)")
    parser.add_argument("--rates", action="store_true", help="compare cells a second and GB/s as well")
    given = parser.parse_args()
    cases = []
    for path in (given.old, given.new):
        with open(path) as file:
            cases.append(read(file.read()))
    for name in sorted(cases[0].keys() ^ cases[1].keys()):
        print(f"{name:34} only in {given.old if name in cases[0] else given.new}")
    for found in moved(*cases, RATIOS + (RATES if given.rates else ()), given.band / 100):
        print(line(*found))
    for found in moved(*cases, COUNTS, 1e-9):
        print(line(*found))


if __name__ == "__main__":
    main()
