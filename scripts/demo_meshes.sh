#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Unpacks the meshes that the demo drops from Debian's package libcgal-demo.
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

# The package calls it documentation, and small installations (container images above all) leave out /usr/share/doc. The
# package file itself still has it.
archive=/usr/share/doc/libcgal-dev/data.tar.gz
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
if [ ! -r "$archive" ]; then
  command -v apt-get >/dev/null && command -v dpkg-deb >/dev/null || exit 1
  echo "The meshes of libcgal-demo are not on this machine: fetching the package to take them out of it" >&2
  chmod 755 "$scratch"
  (cd "$scratch" && apt-get -q download libcgal-demo >&2) || exit 1
  dpkg-deb --fsys-tarfile "$scratch"/libcgal-demo_*.deb | tar -x -C "$scratch" ".$archive" || exit 1
  archive=$scratch$archive
fi
tar -xzf "$archive" -C "$scratch" "${wanted[@]}" || exit 1
for path in "${wanted[@]}"; do
  # Written under another name first: an interrupted run must not leave half a mesh that the next one takes for whole.
  cp "$scratch/$path" "$folder/.${path##*/}.part"
  mv "$folder/.${path##*/}.part" "$folder/${path##*/}"
done
