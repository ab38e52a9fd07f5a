#!/bin/bash
# What cmake --install and cpack make of a built tree: the program, its pages, and the engine for C++.
#   tests/package_test.sh TREE
set -eu
root=$(dirname "$(dirname "$(readlink -f "$0")")")
tree=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "FAILED: $*"; exit 1; }
expect() { grep -q -- "$1" <<<"$2" || fail "no '$1' in: $2"; }

# A Debian package from the tree, unpacked rather than installed: the same files, and no change to this machine.
(cd "$tree" && cpack -B "$work/pack" >"$work/cpack.log" 2>&1) || { cat "$work/cpack.log"; fail "cpack"; }
deb=$(echo "$work"/pack/*.deb)
depends=$(dpkg-deb -f "$deb" Depends)
for needed in libc6 libvtk9 libhdf5 libyaml-cpp libgl1-mesa-dri fonts-dejavu-core; do expect "$needed" "$depends"; done
dpkg-deb -x "$deb" "$work/root"
usr=$work/root/usr
[ -f "$usr/share/doc/hourglass/copyright" ] || fail "no copyright"

# The program, away from its tree.
cd "$work"
program=$usr/bin/hourglass
readelf -d "$program" | grep -q "RUNPATH.*$tree" && fail "the program looks for libraries in its tree"
expect "git revision" "$("$program" --version)"
"$program" run "$usr/share/hourglass/configs/silo.yaml" --quiet --out run --set grid.cells_x=32 --set time.end=2 \
  --set output.snapshots_every=1 2>/dev/null
for file in summary.json series.csv fields.h5 fields.xdmf; do [ -s "run/$file" ] || fail "no $file"; done
ls run/snapshots/*.png >/dev/null || fail "no picture"

# Its man page: every command, and nothing that groff minds.
page=$(gunzip -cf "$usr"/share/man/man1/hourglass.1*)
commands=$("$program" --help | sed '1,/^Subcommands:/d' | awk '/^  [a-z]/ {print $1}')
[ -n "$commands" ] || fail "no commands in --help"
for command in $commands; do expect "^.SS \"hourglass $command" "$page"; done
[ -z "$(groff -man -Tutf8 -ww <<<"$page" 2>&1 >/dev/null)" ] || fail "groff: $(groff -man -Tutf8 -ww <<<"$page" 2>&1 >/dev/null)"

# Completion, as bash asks for it.
complete() {  # complete WORD...: what bash would offer for the last one
  bash -c '. "$0"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _hourglass; echo "${COMPREPLY[*]}"' \
    "$usr/share/bash-completion/completions/hourglass" "$@"
}
[ "$(complete hourglass swe)" = sweep ] || fail "completion of swe: $(complete hourglass swe)"
[ "$(complete hourglass run --thr)" = --threads ] || fail "completion of --thr"
[ "$(complete hourglass render --overlay st)" = streamlines ] || fail "completion of a word"
[ "$(complete hourglass run run/su)" = run/summary.json ] || fail "completion of a file"
if command -v zsh >/dev/null; then zsh -n "$usr/share/zsh/vendor-completions/_hourglass"; fi

# The engine for C++.
cmake -S "$root/examples/engine" -B example -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$usr" >cmake.log 2>&1 ||
  { cat cmake.log; fail "find_package(hourglass)"; }
cmake --build example >build.log 2>&1 || { cat build.log; fail "the example does not build"; }
rate=$(example/drain | sed -n 's/discharge rate \([0-9.]*\) .*/\1/p')
"$program" run "$usr/share/hourglass/configs/silo.yaml" --quiet --out same --set grid.cells_x=64 --set time.end=20 \
  --set stop= --set output.fields_every=0 --set output.snapshots_every=0 2>/dev/null
python3 - "$rate" <<'END'
import json, sys
rate = json.load(open("same/summary.json"))["discharge_rate"]
assert abs(float(sys.argv[1]) / rate - 1) < 1e-3, f"the example drains at {sys.argv[1]}, the program at {rate}"
END
echo "package: $(basename "$deb"), $(du -sh "$deb" | cut -f1)"
