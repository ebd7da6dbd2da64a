#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# darkplaces.sh [BUILD]: the game engine DarkPlaces, as Debian builds its server on libode8, with a stack of five boxes that
# are dTriMeshes on a world that is one: as it is and with the preloadable library before it, and with boxes of the engine
# instead. Prints a table in Markdown. What is not installed (darkplaces-server, fteqcc) is fetched and unpacked.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
library=$(cd "${1:-$here/../../build}" && pwd)/lib/libode_trimesh_gpu_preload.so
scratch=$(mktemp -d)
trap 'rm -r "$scratch"' EXIT
PATH=$PATH:/usr/games:$scratch/usr/games:$scratch/usr/bin
for package in darkplaces-server fteqcc; do
  command -v "$package" >/dev/null && continue
  (cd "$scratch" && apt-get download "$package" >/dev/null && dpkg-deb -x "$package"_*.deb .)
done

game=$scratch/game/id1
mkdir -p "$game/maps"
cp "$here/darkplaces_stack.qc" "$scratch/stack.qc"
printf 'game/id1/progs.dat\nstack.qc\n' >"$scratch/progs.src"
(cd "$scratch" && fteqcc -Tid >compiler.txt) || { cat "$scratch/compiler.txt" >&2; exit 1; }
# Boxes in the engine's units, of which a metre has 32.
box() {
  awk -v x="$1" -v low="$2" -v high="$3" 'BEGIN {
    print "o box\nusemtl none\nvt 0 0"
    for (i = 0; i < 8; ++i) print "v", i < 4 ? -x : x, int(i / 2) % 2 ? high : low, i % 2 ? x : -x
    n = split("0 1 3 0 3 2 4 6 7 4 7 5 0 4 5 0 5 1 2 3 7 2 7 6 0 2 6 0 6 4 1 5 7 1 7 3", c, " ")
    for (i = 1; i <= n; i += 3) printf "f %d/1 %d/1 %d/1\n", c[i] + 1, c[i + 1] + 1, c[i + 2] + 1
  }'
}
box 16 -16 16 >"$game/box.obj"
box 512 -64 0 >"$game/maps/slab.obj"
printf '{\n"classname" "worldspawn"\n}\n{\n"classname" "info_player_start"\n"origin" "0 0 64"\n}\n' >"$game/maps/slab.ent"

echo '| boxes | library | farthest aside, m | height of the top one, m | most tilted, degrees | lines of warning |'
echo '|---|---|---|---|---|---|'
for solid in 35 32; do
  for preload in '' "$library"; do
    [ "$solid" = 35 ] || [ -z "$preload" ] || continue  # ODE's own boxes on a dTriMesh are another question
    LD_PRELOAD=$preload timeout 300 darkplaces-server -basedir "$scratch/game" +sv_random_seed 1 +host_framerate 0.0166 \
      +physics_ode 1 +physics_ode_iterationsperframe 4 +physics_ode_contact_erp 0.2 \
      +physics_ode_contactsurfacelayer 0.05 +saved1 "$solid" +map slab.obj >"$scratch/out" 2>"$scratch/err" </dev/null
    python3 - "$solid" "${preload:+yes}" "$scratch" <<'PYTHON'
import math, re, sys
solid, preload, scratch = sys.argv[1:]
boxes = []
for line in open(scratch + "/out", errors="replace"):
    if line.startswith("box "):
        boxes.append([float(x) for x in re.findall(r"-?\d+\.\d+", line)])
if len(boxes) != 5:
    sys.exit("the server did not say where the boxes are:\n" + open(scratch + "/out", errors="replace").read())
aside = max(math.hypot(b[0], b[1]) for b in boxes) / 32
tilt = max(math.degrees(math.acos(max(-1, min(1, math.cos(math.radians(b[3])) * math.cos(math.radians(b[5]))))))
           for b in boxes)
lines = [line for line in open(scratch + "/err") if "ODE" in line or "ode_" in line]
print("| %s | %s | %.2g | %.2f | %.2g | %d |" % (
    "`dBox` of the engine" if solid == "32" else "dTriMesh of 12 triangles", preload or "no", aside,
    max(b[2] for b in boxes) / 32, tilt, len(lines)))
PYTHON
  done
done
