#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# stormbaancoureur.sh [BUILD] [SECONDS]: Debian's game Stormbaan Coureur, drawn into nothing (Xvfb), as it is and with the
# preloadable library before it. Prints what the game and the library say of ODE, and warnings.
# Needs the packages stormbaancoureur, xvfb and libxtst6.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
build=$(cd "${1:-$here/../../build}" && pwd)
seconds=${2:-40}
game=/usr/games/stormbaancoureur
[ -x "$game" ] || { echo "left out: stormbaancoureur is not installed" >&2; exit 0; }
scratch=$(mktemp -d)
trap 'rm -r "$scratch"' EXIT
for preload in '' "$build/lib/libode_trimesh_gpu_preload.so"; do
  Xvfb -displayfd 3 -screen 0 320x240x24 3>"$scratch/display" 2>/dev/null &
  server=$!
  until [ -s "$scratch/display" ]; do sleep 0.2; done
  export DISPLAY=":$(cat "$scratch/display")" HOME="$scratch"
  export PLODE_NO_SHADOWS=1 PLODE_LOW_DETAIL=1 PLODE_NO_SOUND=1 OTG_PRELOAD_VERBOSE=1
  LD_PRELOAD=$preload "$game" >"$scratch/out" 2>&1 &
  sleep 5
  python3 "$here/press_keys.py" "$seconds"
  echo "== library: $([ -n "$preload" ] && echo yes || echo no)"
  kill "$server"  # the game ends as one does whose window is closed, and the library says what it has done
  wait || true
  grep -iE 'ode|warning|error|assert' "$scratch/out" || true
  rm "$scratch/display"
done
