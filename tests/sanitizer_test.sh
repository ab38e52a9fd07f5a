#!/bin/bash
# Tests under a sanitizer: builds some suites with the preset and runs those of their cases that are fast.
#   tests/sanitizer_test.sh asan|tsan SUITE...
set -eu
root=$(dirname "$(dirname "$(readlink -f "$0")")")
preset=$1
shift
cd "$root"
cmake --preset "$preset" >/dev/null
log=build/$preset/build.log
cmake --build --preset "$preset" --target "$@" >"$log" 2>&1 || { tail -n 40 "$log"; exit 1; }
# Left out: what counts the iterations of large solves, on one thread, and whole drains and their mirror images: half of the
# time, for code that the others run too.
heavy='iterations do not depend on the grid or the contrast|absorption from 1e-8|checkerboard of small|float is as good'
heavy="$heavy|mirrored silo|mirrored orifice|a whole drain at|round silo keeps account|aspect ratios 0.5|every combination of modules"
ctest --preset "$preset" -L fast -R "^($(IFS='|'; echo "$*"))" -E "$heavy" -j "$(nproc)"
