#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Draws the pictures of docs/contacts.md: contact_pictures.sh FOLDER [MESH...]. Needs build/bin/otg_bench and POV-Ray.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
[ $# -ge 1 ] || { echo "usage: $0 FOLDER [MESH...]" >&2; exit 2; }
folder=$1
shift
scenes=$(mktemp -d)
trap 'rm -rf "$scenes"' EXIT
build/bin/otg_bench contacts --pictures "$scenes" "$@"
mkdir -p "$folder"
for scene in "$scenes"/*.pov; do
  picture=$folder/$(basename "${scene%.pov}").png
  # Three panels of 1 : 1.1. No window (-D), and more samples where neighbouring pixels differ (+A).
  povray "+I$scene" "+O$picture" +W960 +H352 +A0.2 +AM2 +R2 -D -GA >"$scenes/povray.log" 2>&1 ||
    { cat "$scenes/povray.log" >&2; exit 1; }
  echo "$picture"
done
