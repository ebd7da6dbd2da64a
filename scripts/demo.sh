#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The falling-meshes demo: steps an ODE world headless and leaves pictures, a plot, an animation and the numbers in out/.
# Installs what is missing first (see install_dependencies.sh); no part of it needs a display.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

bash scripts/install_dependencies.sh demo

jobs=$(nproc)
demo=demos/falling_meshes
work=build/demo
times=(0.3 0.5 0.7 0.9 1.2 5.0)  # of the six pictures, in seconds
echo "== configure and build" >&2
cmake --preset default >&2
# The libraries too, so that `cmake --install build` works afterwards: their objects are those of otg.
cmake --build --preset default --target otg ode_trimesh_gpu ode_trimesh_gpu_static ode_trimesh_gpu_preload -- -j"$jobs" >&2

mkdir -p out "$work"
rm -rf "$work/frames" out/frame_*.png
if bash scripts/demo_meshes.sh "$work" armadillo elephant camel knot2; then
  scene=$work/falling_meshes.json
  cp "$demo/falling_meshes.json" "$scene"
else
  echo "The meshes of libcgal-demo cannot be had here: generated ones fall instead" >&2
  scene=$demo/falling_lumps.json
fi

echo "== simulate" >&2
build/bin/otg simulate "$scene" --csv out/falling_meshes.csv --glb out/falling_meshes.glb --html out/falling_meshes.html \
  --povray "$work/frames" --picture-times "$(IFS=,; echo "${times[*]}")" >"$work/summary.txt"

echo "== draw" >&2
number=0
# draw FRAME PICTURE [WORD...]: no window (-D), and more samples where neighbouring pixels differ (+A).
draw() {
  local frame=$1 picture=$2
  shift 2
  povray "+I$frame" "+L$demo" "+L$work/frames" "+O$picture" +W960 +H540 +A0.15 +AM2 +R2 -D -GA "$@" \
    >"$work/povray.log" 2>&1 || { cat "$work/povray.log" >&2; exit 1; }
  echo "$picture" >&2
}
for frame in "$work"/frames/frame_*.pov; do
  number=$((number + 1))
  draw "$frame" "out/frame_$number.png"
done
draw "$frame" out/contacts_at_rest.png Declare=ShowContacts=1
gnuplot -e "csv='out/falling_meshes.csv'; png='out/contacts.png'" "$demo/contacts.gp"
gnuplot -e "pictures='out/frame_%d.png'; times='${times[*]}'; png='out/falling_meshes.png'" "$demo/contact_sheet.gp"

echo
cat "$work/summary.txt"
echo
echo "out/falling_meshes.png   the pictures side by side (one by one: out/frame_1.png to out/frame_$number.png)"
echo "out/falling_meshes.html  plays the run in a browser: orbit, time line, contacts, charts"
echo "out/contacts_at_rest.png the last picture with its contacts: arrows, whose colour is the penetration depth"
echo "out/contacts.png         contacts and times over the steps"
echo "out/falling_meshes.glb   the animation: opens in Blender or any glTF viewer"
echo "out/falling_meshes.csv   the numbers of every step"
