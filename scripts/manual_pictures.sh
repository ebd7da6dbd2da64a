#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Draws the contacts in the manual's pictures: manual_pictures.sh [FOLDER] (docs/pictures). Steps the scenes of docs/scenes/ and
# draws where each ends. Needs build/bin/otg and POV-Ray.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
folder=${1:-docs/pictures}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for scene in docs/scenes/*.json; do
  name=$(basename "$scene" .json)
  build/bin/otg simulate "$scene" --povray "$work/$name" --picture-times 100 >"$work/$name.txt"
  povray "+I$work/$name/frame_000.pov" +Ldemos/falling_meshes "+L$work/$name" "+O$work/$name.png" +W640 +H400 +A0.15 +AM2 +R2 -D -GA \
    Declare=ShowContacts=1 >"$work/povray.log" 2>&1 || { cat "$work/povray.log" >&2; exit 1; }
  cp "$work/$name.png" "$folder/manual_$name.png"
  echo "$folder/manual_$name.png"
done
