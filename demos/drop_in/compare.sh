#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# compare.sh [BUILD]: runs every program of this folder as it is and with the preloadable library before it, and prints a
# table in Markdown: what became of the stack, the time of a step (median of three runs) and the lines on the terminal. A
# second table is of shapes of ODE's own on a road that is a dTriMesh, with these pairs taken over, too.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
build=$(cd "${1:-$here/../../build}" && pwd)
scratch=$(mktemp -d)
trap 'rm -r "$scratch"' EXIT

echo '| program | library | drift, m | tilt, degrees | height error, m | contacts in a step | ms for a step | lines of warning |'
echo '|---|---|---|---|---|---|---|---|'
compare() {
  local name=$1 preload run
  shift
  for preload in '' "$build/lib/libode_trimesh_gpu_preload.so"; do
    : >"$scratch/out"
    for run in 1 2 3; do
      if ! LD_PRELOAD=$preload "$@" >>"$scratch/out" 2>"$scratch/err"; then
        echo "left out: $name: $(tail -n 1 "$scratch/err")" >&2
        return 0
      fi
    done
    python3 - "$name" "${preload:+yes}" "$scratch" <<'PYTHON'
import json, statistics, sys
name, preload, scratch = sys.argv[1:]
runs = [json.loads(line) for line in open(scratch + "/out")]
lines = [line for line in open(scratch + "/err") if line.strip()]
last = runs[-1]
print("| %s | %s | %.2g | %.2g | %.2g | %.3g | %.2f | %d |" % (
    name, preload or "no", last["drift_m"], last["tilt_deg"], last["height_error_m"], last["contacts_per_step"],
    statistics.median(run["ms_per_step"] for run in runs), len(lines)))
PYTHON
  done
}
stack="$build/bin/demo_drop_in_stack"
compare "C, 5 boxes of 12 triangles, \`dWorldStep\`" "$stack" 5 2000
compare "C, 10 boxes of 12 triangles, \`dWorldQuickStep\`" "$stack" 10 2000 1 quick
compare "C, 10 boxes of 768 triangles, \`dWorldQuickStep\`" "$stack" 10 2000 8 quick
compare "C, 10 \`dBox\` instead, \`dWorldQuickStep\`" "$stack" 10 2000 0 quick
[ ! -x "$build/bin/demo_drop_in_dart" ] || compare "DART 6.12, 5 boxes" "$build/bin/demo_drop_in_dart" 5 2000
compare "PyODE 1.2, 5 boxes" /usr/bin/python3 "$here/pyode_stack.py" 5 2000

echo
echo '| on a road of | library | way, m | aside, mm | bumps, mm | contacts in a step | first collision, ms | later ones, microseconds | lines of warning |'
echo '|---|---|---|---|---|---|---|---|---|'
for shape in cylinder drum box capsule sphere; do
  for road in '40 0' '400 400' '400 2' '40 0.25'; do
    for preload in '' "$build/lib/libode_trimesh_gpu_preload.so"; do
      [ "$road" != '40 0' ] || [ -z "$preload" ] || continue  # a dPlane: there is no dTriMesh
      # shellcheck disable=SC2086
      OTG_PRELOAD_PRIMITIVES=all LD_PRELOAD=$preload "$build/bin/demo_drop_in_wheel" $shape $road 960 \
        >"$scratch/out" 2>"$scratch/err"
      python3 - "${preload:+yes}" "$scratch" <<'PYTHON'
import json, sys
preload, scratch = sys.argv[1:]
run = json.load(open(scratch + "/out"))
lines = [line for line in open(scratch + "/err") if line.strip()]
road = "`dPlane`" if run["triangles"] == 0 else "%d triangles" % run["triangles"]
print("| %s, %s | %s | %.3f | %.2g | %.2g | %.3g | %.2g | %.2g | %d |" % (
    run["shape"], road, preload or "no", run["way_m"], 1e3 * run["aside_m"], 1e3 * run["bumps_m"],
    run["contacts_per_step"], run["first_ms"], 1e3 * run["collide_ms"], len(lines)))
PYTHON
    done
  done
done
