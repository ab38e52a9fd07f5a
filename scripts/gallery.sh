#!/bin/sh
# Draws docs/gallery/: a picture of each scene with a geometry of its own, by the program itself.
#   scripts/gallery.sh [PROGRAM]
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
program=${1:-$root/build/release/hourglass}
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
mkdir -p "$root/docs/gallery"
for scene in two_orifices three_orifices uneven_orifices side_orifice hopper round_silo draw_points steady_feed \
    inserts/square inserts/rectangle inserts/diamond inserts/triangle_up inserts/triangle_down inserts/circle; do
  name=$(basename "$scene")
  "$program" run "$root/configs/$scene.yaml" --set time.end=27.4 --set stop={} --set output.fields_every=27.4 \
    --set output.snapshots_every=0 --out "$out/$name" --quiet
  "$program" render "$out/$name" --field speed --time 27.4 --overlay streamlines --overlay quasi_static
  picture=$root/docs/gallery/$name.png
  mv "$out/$name"/pictures/speed_*.png "$picture"
  python3 "$root/scripts/halve_png.py" "$picture"
done
