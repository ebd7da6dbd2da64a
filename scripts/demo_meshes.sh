#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Unpacks meshes of Debian's package libcgal-demo.
#
#   scripts/demo_meshes.sh FOLDER NAME...     leaves FOLDER/NAME.off; exit status 1 if one cannot be had
set -euo pipefail

folder=$1
shift
mkdir -p "$folder"
wanted=()
for name in "$@"; do
  [ -s "$folder/$name.off" ] || wanted+=("data/meshes/$name.off")
done
[ ${#wanted[@]} -gt 0 ] || exit 0

archive=$(bash "$(dirname "${BASH_SOURCE[0]}")/cgal_meshes.sh" "$folder") || exit 1
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
tar -xzf "$archive" -C "$scratch" "${wanted[@]}" || exit 1
for path in "${wanted[@]}"; do
  # Copied under another name first: an interrupted run must not leave half a mesh that the next one takes for whole.
  cp "$scratch/$path" "$folder/.${path##*/}.part"
  mv "$folder/.${path##*/}.part" "$folder/${path##*/}"
done
