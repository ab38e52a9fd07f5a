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
ctest --preset "$preset" -L fast -R "^($(IFS='|'; echo "$*"))" -j "$(nproc)"
