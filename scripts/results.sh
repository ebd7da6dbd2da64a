#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Writes docs/results/: every table of numbers, with command, commit, machine and date. Needs a build (build/bin/otg).
#
#   scripts/results.sh                      tables of the CPU, on any machine
#   scripts/results.sh --device             those of the default OpenCL device
#   scripts/results.sh --only NAME...       some pages
#   OTG_RESULTS=FOLDER scripts/results.sh   into another folder
#   OTG_COMMIT=HASH scripts/results.sh      the commit, where there is no repository
#
# Meshes lie in out/meshes; scripts/benchmark_meshes.sh makes them if they are missing.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root"
if ! ls out/meshes/armadillo_*.ply >/dev/null 2>&1; then
  bash scripts/benchmark_meshes.sh out/meshes || echo "note: without meshes of the package; generated ones are used" >&2
fi
meshes=()
if ls out/meshes/armadillo_*.ply >/dev/null 2>&1; then meshes=(--meshes out/meshes); fi
exec python3 -B scripts/results.py build/bin/otg "${OTG_RESULTS:-docs/results}" "${meshes[@]}" "$@"
