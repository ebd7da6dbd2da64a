#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Prints the path of the archive of meshes that Debian's package libcgal-demo ships; exit status 1 if it cannot be had.
#
#   scripts/cgal_meshes.sh FOLDER     FOLDER keeps the archive where it had to be fetched
set -euo pipefail

installed=/usr/share/doc/libcgal-dev/data.tar.gz
if [ -r "$installed" ]; then
  echo "$installed"
  exit 0
fi

# The package calls it documentation, and small installations (container images above all) leave out /usr/share/doc. The
# package file itself still has it.
mkdir -p "$1"
kept=$(cd "$1" && pwd)/libcgal-demo_data.tar.gz
if [ ! -s "$kept" ]; then
  command -v apt-get >/dev/null && command -v dpkg-deb >/dev/null || exit 1
  scratch=$(mktemp -d)
  trap 'rm -rf "$scratch"' EXIT
  chmod 755 "$scratch"
  echo "The meshes of libcgal-demo are not on this machine: fetching the package to take them out of it" >&2
  (cd "$scratch" && apt-get -q download libcgal-demo >&2) || exit 1
  dpkg-deb --fsys-tarfile "$scratch"/libcgal-demo_*.deb | tar -x -C "$scratch" ".$installed" || exit 1
  mv "$scratch$installed" "$kept"
fi
echo "$kept"
