#!/bin/bash
# docs/python.md's ParaView script, run by ParaView itself. Debian's paraview cannot be installed beside libvtk9-dev, so its
# packages are unpacked in the build tree. Skipped (status 77) with a word where they cannot be had.
#   tests/paraview_test.sh HOURGLASS TREE
set -eu
root=$(dirname "$(dirname "$(readlink -f "$0")")")
program=$1
paraview=$2/paraview
skip() { echo "skipped: $*"; exit 77; }

if [ ! -x "$paraview/usr/bin/pvpython" ]; then
  rm -rf "$paraview" "$paraview.debs"
  mkdir -p "$paraview" "$paraview.debs"
  (cd "$paraview.debs" && { apt-get download paraview python3-paraview || { apt-get update && apt-get download paraview python3-paraview; } }) \
    >"$paraview.log" 2>&1 || skip "Debian's paraview cannot be fetched here"
  for deb in "$paraview.debs"/*.deb; do dpkg-deb -x "$deb" "$paraview"; done
  rm -rf "$paraview.debs"
fi
export LD_LIBRARY_PATH PYTHONPATH=$paraview/usr/lib/python3/dist-packages
LD_LIBRARY_PATH=$(find "$paraview/usr/lib" -name '*.so*' -printf '%h\n' | sort -u | tr '\n' ':')
"$paraview/usr/bin/pvpython" -c 'import paraview.simple' >/dev/null 2>&1 || skip "Debian's paraview does not start here"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
run=$(sed -n '0,/^    hourglass run /s/^    hourglass run //p' "$root/docs/python.md" | head -n 1)
# shellcheck disable=SC2086  # the command line of the page
(cd "$root" && env -u LD_LIBRARY_PATH "$program" run $run --out "$work/runs/silo" --quiet --set output.snapshots_every=0) 2>/dev/null
sed -n '/^```paraview$/,/^```$/p' "$root/docs/python.md" | sed '1d;$d' >page.py
cat >>page.py <<'END'

# What h5py says of the same frames is what ParaView has to say. Run by pvpython, which is built on Debian's python.
import h5py
stored = h5py.File("runs/silo/fields.h5")
frames = [stored["frames"][name] for name in stored["frames"]]
assert len(times) == len(frames) > 10, (len(times), len(frames))
for t, frame in zip(times, frames):
    assert abs(t - frame.attrs["time"]) < 1e-9 * max(t, 1)
    run.UpdatePipeline(t)
    low, high = run.CellData["speed"].GetRange()
    assert high == frame["speed"][:].max() and low == frame["speed"][:].min()
h, n = stored.attrs["spacing"], int((frames[-1]["grains"][:] >= 0.5).sum())
assert grains.GetDataInformation().GetNumberOfCells() == n, (grains.GetDataInformation().GetNumberOfCells(), n)
bounds = run.GetDataInformation().GetBounds()
assert abs(bounds[1] - 150) < 1e-9 and abs(bounds[3] - 150) < 1e-9, bounds
for name in ("speed", "pressure", "grains", "velocity"):
    assert run.CellData[name] is not None, name
print("paraview: ok")
END
sed 's/^import h5py$/import sys; sys.path.append("\/usr\/lib\/python3\/dist-packages"); import h5py/' -i page.py
"$paraview/usr/bin/pvpython" page.py >said 2>&1 || { cat said; exit 1; }
grep -q 'paraview: ok' said || { cat said; exit 1; }
grep 'greatest speed' said
