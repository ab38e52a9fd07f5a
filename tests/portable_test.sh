#!/bin/bash
# The portable build: the unit tests of the engine on every vector width that this machine can run, and the widest one
# when nobody chooses.
set -eu
root=$(dirname "$(dirname "$(readlink -f "$0")")")
tree=$root/build/portable
cd "$root"
cmake --preset portable -DHOURGLASS_WERROR=ON -DHOURGLASS_BENCHMARKS=OFF >/dev/null
cmake --build --preset portable --target unit_solver >"$tree/build.log" 2>&1 || { tail -n 40 "$tree/build.log"; exit 1; }

only=$(mktemp -d)  # holds one build at a time: beside its sister folders the loader would take the best
trap 'rm -rf "$only"' EXIT
widest=128
for build in . glibc-hwcaps/x86-64-v3 glibc-hwcaps/x86-64-v4; do
  level=${build#glibc-hwcaps/}
  case $level in .) width=128 ;; x86-64-v3) width=256 ;; x86-64-v4) width=512 ;; esac
  if [ "$level" != . ] && ! /lib64/ld-linux-x86-64.so.2 --help | grep -q "$level (supported"; then
    echo "$level: this machine cannot run it, skipped"
    continue
  fi
  widest=$width
  cp "$tree/lib/$build/libhourglass_solver.so" "$only"
  echo "vectors of $width bits:"
  HOURGLASS_SIMD=$width LD_LIBRARY_PATH=$only "$tree/tests/unit_solver" '~[slow]'
done
echo "when nobody chooses:"
HOURGLASS_SIMD=$widest "$tree/tests/unit_solver" "the engine has the vectors that were asked for"
