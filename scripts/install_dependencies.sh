#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs with apt what this project needs and the machine lacks; does nothing (and asks for no rights) where all is there.
#
#   scripts/install_dependencies.sh [build] [tests] [demo] [benchmarks] [drop_in] [lint] [docs] [packages] [python] [viewer]     (default: build)
#
# Written for Debian 12. Needs root or sudo only when something is missing.
set -euo pipefail

# The library, the programs otg and otg_bench. Where no more is installed the default preset leaves out the tests, with a
# message.
build_packages=(
  g++ cmake ninja-build pkg-config
  libode-dev libeigen3-dev opencl-c-headers
  libassimp-dev libcli11-dev nlohmann-json3-dev libfmt-dev libtinygltf-dev libjs-three help2man
)
# What tests are made with; an OpenCL device that every machine has, one that is simulated, and real meshes. Clang and its
# runtime are for AddressSanitizer with libFuzzer.
tests_packages=(
  catch2 python3 libcgal-dev ocl-icd-opencl-dev opencl-clhpp-headers clang libclang-rt-14-dev
  pocl-opencl-icd oclgrind libcgal-demo
)
# A ray tracer, a plotter and its font, none of which needs a display. The demo's meshes are those of libcgal-demo. That
# package needs all of CGAL, so it is not installed: cgal_meshes.sh takes the meshes out of it.
demo_packages=(povray gnuplot-nox fonts-dejavu-core)
# Collision libraries to compare with. Benchmarks leave out, with a message, those that are not installed. CGAL makes the sizes of
# the benchmarks' body (benchmark_meshes.sh), which is one of libcgal-demo's.
benchmarks_packages=(libfcl-dev libbullet-dev libembree-dev libcgal-dev libcgal-demo)
# Programs that the preloadable library is shown with. Their demos are left out, with a message, where they are missing.
drop_in_packages=(libdart-collision-ode-dev python3-pyode stormbaancoureur xvfb libxtst6)
# What the wheel is built with. The other tools come from PyPI: see scripts/python.sh.
python_packages=(python3-dev python3-venv)
# The page of a run in a browser (tests/robustness/viewer), and those of the site (docs/site/check_pages.py). Both are skipped
# without, outside of ci.sh: a minimal Debian downloads 208 MB for the browser.
viewer_packages=(chromium)
# Format and static checks of the sources. ruff comes from PyPI.
lint_packages=(clang-format clang-tidy git python3-venv)
# The site of the manual (docs.sh).
docs_packages=(doxygen python3 python3-venv)
# Debian packages, and a Debian in a folder to try them in (packages.sh).
packages_packages=(dpkg-dev fakeroot file lintian mmdebstrap)
# Rows of the matrix of continuous integration (ci.sh).
ci_gcc_packages=(gcc-12 g++-12)
ci_clang_packages=(clang-14)
ci_clang19_packages=(clang-19)
ci_simd_packages=(gcc-12 g++-12 qemu-user)
ci_aarch64_packages=(gcc-aarch64-linux-gnu g++-aarch64-linux-gnu qemu-user)
ci_mingw_packages=(g++-mingw-w64-x86-64-posix gcc-mingw-w64-x86-64-posix wine64)
ci_conan_packages=(python3-venv)
ci_gazebo_packages=(libignition-physics-mesh-dev libignition-physics-sdf-dev libignition-physics5-dartsim-plugin5 libdart-collision-ode-dev)

wanted=("${build_packages[@]}")
for set in "$@"; do
  case "$set" in
    build) ;;
    tests) wanted+=("${tests_packages[@]}") ;;
    demo) wanted+=("${demo_packages[@]}") ;;
    benchmarks) wanted+=("${benchmarks_packages[@]}") ;;
    drop_in) wanted+=("${drop_in_packages[@]}") ;;
    lint) wanted+=("${lint_packages[@]}") ;;
    python) wanted+=("${python_packages[@]}") ;;
    docs) wanted+=("${docs_packages[@]}") ;;
    viewer) wanted+=("${viewer_packages[@]}") ;;
    packages) wanted+=("${packages_packages[@]}") ;;
    ci_*)
      declare -n of_row=${set}_packages
      [ -n "${of_row[*]-}" ] || { echo "$0: unknown set '$set'" >&2; exit 2; }
      wanted+=("${of_row[@]}") ;;
    *) echo "$0: unknown set '$set' (build, tests, demo, benchmarks, drop_in, lint, docs, packages, python, viewer)" >&2; exit 2 ;;
  esac
done

if ! command -v dpkg-query >/dev/null; then
  echo "This is no Debian-like system, so nothing was installed. Needed (Debian names): ${wanted[*]}" >&2
  exit 0
fi

missing=()
for package in "${wanted[@]}"; do
  status=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)
  [ "$status" = installed ] || missing+=("$package")
done
[ ${#missing[@]} -gt 0 ] || exit 0

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v sudo >/dev/null; then
    echo "Missing packages, and neither root nor sudo to install them: apt-get install ${missing[*]}" >&2
    exit 1
  fi
  as_root=(sudo)
fi
echo "Installing with apt: ${missing[*]}" >&2
apt_options=(-y -q --no-install-recommends -o Dpkg::Use-Pty=0 -o APT::Install-Suggests=0)
{
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q update
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get "${apt_options[@]}" install "${missing[@]}"
} >&2
