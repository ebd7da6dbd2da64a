#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds the manual as a site: build/docs/html/index.html. The C API comes from the headers by Doxygen, the pages from docs/ by
# Sphinx. Fails at an undocumented parameter, at a link that leads nowhere, and at any other warning of the two. Where Chromium is
# installed also at a page that scrolls sideways, on a desktop or a phone, and at a broken picture.
#
#   scripts/docs.sh              the pages and the API; the gallery, too, if it was built before
#   scripts/docs.sh --gallery    also builds the Python package and runs the scripts of docs/gallery, whose pictures the site shows
#
# Sphinx and its parts come from PyPI into a virtual environment below build/docs/, in the versions of docs/site/requirements.txt.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

bash scripts/install_dependencies.sh docs

work=$PWD/build/docs
mkdir -p "$work"
if ! cmp -s docs/site/requirements.txt "$work/venv/requirements.txt"; then
  echo "== Sphinx" >&2
  rm -rf "$work/venv"
  python3 -m venv "$work/venv"
  "$work/venv/bin/pip" install --quiet --disable-pip-version-check -r docs/site/requirements.txt
  cp docs/site/requirements.txt "$work/venv/requirements.txt"
fi

if [ "${1:-}" = --gallery ]; then
  echo "== the Python package" >&2
  bash scripts/python.sh --wheel
  "$work/venv/bin/pip" install --quiet --disable-pip-version-check matplotlib coal manifold3d "$(echo out/wheels/*.whl)[all]"
  "$work/venv/bin/pip" install --quiet --disable-pip-version-check --force-reinstall --no-deps out/wheels/*.whl
fi

echo "== Doxygen" >&2
BUILD=$work/doxygen
mkdir -p "$BUILD"
BUILD=$BUILD doxygen docs/site/Doxyfile

echo "== Sphinx" >&2
rm -rf "$work/html"
PYVISTA_OFF_SCREEN=true MPLBACKEND=Agg OTG_DOCS_XML=$BUILD/xml "$work/venv/bin/sphinx-build" -q -E -n -W --keep-going -c docs/site -d "$work/doctrees" docs "$work/html"

python3 -B docs/site/check_links.py "$work/html"
python3 -B docs/site/check_pages.py "$work/html"
# A header without its section in the API would be lost.
for header in ode_trimesh_gpu/include/ode_trimesh_gpu/*.h; do
  name=$(basename "$header")
  [ "$name" = ode_trimesh_gpu.h ] || [ "$name" = export.h ] || grep -q "doxygenfile} $name" docs/api.md ||
    { echo "docs/api.md does not show $name" >&2; exit 1; }
done
echo "build/docs/html/index.html"
