#!/usr/bin/env python3
"""The tables of README.md from the JSON of benchmark programs: table.py RUN.json..."""
import re
import sys

from compare import read

SIZES = (128, 256, 512, 1024, 2048)


def kernels(cases):
    """Million cells a second on one thread, per cent of the roof, times the plain twin; two threads over one."""
    found = {}
    for case, counters in cases.items():
        match = re.fullmatch(r"(\w+)/(\d+)/threads:(\d)", case)
        if match and "cells/s" in counters:
            found.setdefault(match[1], {})[int(match[2]), int(match[3])] = counters
    sizes = [n for n in SIZES if any((n, 1) in at for at in found.values())]
    if not found:
        return
    print("| | B/cell |" + "".join(f" {n}² |" for n in sizes) + " two threads |\n|" + "---|" * (len(sizes) + 3))
    for name, at in found.items():
        row = [name.replace("_", " "), f"{next(iter(at.values()))['B/cell']:.0f}"]
        for n in sizes:
            c = at[n, 1]
            plain = f", {c['x_plain']:.1f}×" if "x_plain" in c else ""
            row.append(f"{c['cells/s'] / 1e6:.0f} ({c['%roof']:.0f} %{plain})")
        row.append(", ".join(f"{at[n, 2]['cells/s'] / at[n, 1]['cells/s']:.2f}" for n in sizes if (n, 2) in at))
        print("| " + " | ".join(row) + " |")
    print()


def steps(cases):
    rows = [(*case.split("/")[1:], c) for case, c in cases.items() if "speedup_2" in c]
    if not rows:
        return
    print("| flow | grid | iterations, viscous + pressure | cell-steps/s | on two threads | speed-up | B/cell |"
          " roof, 1 and 2 threads | plain cycles | allocations |\n|" + "---|" * 10)
    for flow, n, c in rows:
        print(f"| {flow} | {n}² | {c['viscous_its']:.1f} + {c['pressure_its']:.1f} | {c['cells/s']:.2g} |"
              f" {c['cells/s_2']:.2g} | {c['speedup_2']:.2f} | {c['B/cell']:.0f} |"
              f" {c['%roof']:.0f} %, {c['%roof_2']:.0f} % | {c['x_plain']:.1f}× | {c['allocs/step']:.0f} |")
    print()


def main():
    for path in sys.argv[1:]:
        with open(path) as file:
            cases = read(file.read())
        kernels(cases)
        steps(cases)
        for case, counters in cases.items():
            if case.startswith(("stream/", "step/exponent", "step/neighbour")):
                print(f"{case}: " + ", ".join(f"{key} {value:.3g}" for key, value in counters.items()))


if __name__ == "__main__":
    main()
