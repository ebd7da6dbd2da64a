#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Makes Debian packages by CPack: build-packages/*.deb (library, development, tools, preload, manual, Python).
# nanobind comes from PyPI, into a virtual environment.
#
#   scripts/packages.sh            makes them, and lets lintian look at them: an error of it is one of this script
#   scripts/packages.sh --try      also installs them into a new Debian in a folder, and uses each there (needs root and a mirror)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source=$PWD

bash scripts/install_dependencies.sh packages python

build=$PWD/build-packages
echo "== build" >&2
tools=$build/tools
[ -x "$tools/bin/pip" ] || python3 -m venv "$tools"
"$tools/bin/pip" install -q --disable-pip-version-check 'nanobind>=2.4' numpy >&2
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX=/usr -DOTG_DEBIAN_PACKAGES=ON -DOTG_BUILD_TESTS=OFF \
  -DOTG_BUILD_BENCHMARKS=OFF -DOTG_WARNINGS_AS_ERRORS=ON -DOTG_BUILD_PYTHON=ON -DPython_EXECUTABLE="$tools/bin/python" \
  -DOTG_PYTHON_FOLDER=lib/python3/dist-packages >&2
cmake --build "$build" >&2
rm -f "$build"/*.deb
(cd "$build" && cpack) >&2

echo "== lintian" >&2
lintian --fail-on error --no-tag-display-limit --suppress-tags debian-changelog-has-wrong-day-of-week "$build"/*.deb

if [ "${1:-}" = --try ]; then
  echo "== a new Debian" >&2
  root=$(mktemp -d)
  trap 'rm -rf "$root"' EXIT
  # shellcheck source=/dev/null
  release=$(. /etc/os-release && echo "$VERSION_CODENAME")
  chmod 755 "$root"
  mmdebstrap --mode=root --variant=apt --include=gcc,libc6-dev,pkg-config "$release" "$root/debian" >&2
  cp "$build"/*.deb "$root/debian/tmp/"
  awk '/^```c$/ { on = 1; next } /^```$/ { on = 0 } on' README.md >"$root/debian/tmp/readme_snippet.h"
  cp "$source/tests/robustness/installed_package/main.c" "$root/debian/tmp/"
  awk '/^```python$/ { on = 1; next } /^```$/ { on = 0 } on' python/README.md >"$root/debian/tmp/readme.py"
  cat >"$root/debian/tmp/try.sh" <<'END'
set -eux
export DEBIAN_FRONTEND=noninteractive
apt-get -q update
apt-get -q -y --no-install-recommends install /tmp/*.deb
cd /tmp
gcc main.c -o shared $(pkg-config --cflags --libs ode_trimesh_gpu)
./shared
apt-get -q -y --no-install-recommends install g++  # the archive is written in C++
gcc main.c -o static $(pkg-config --cflags --libs --static ode_trimesh_gpu | sed s/-lode_trimesh_gpu/-l:libode_trimesh_gpu.a/)
./static
otg --version
echo '{"steps": 50, "planes": [{}], "bodies": [{"name": "box", "box": [1, 1, 1], "collider": "ode_trimesh", "position": [0, 0, 0.5]}]}' >scene.json
otg simulate scene.json --html run.html
grep -q three.js run.html
LD_PRELOAD=libode_trimesh_gpu_preload.so OTG_PRELOAD_VERBOSE=1 otg simulate scene.json 2>preload.log
grep -q 'pairs of dTriMesh collide through this library' preload.log
python3 readme.py >python.log
grep -Eq '^[0-9.]+ \[' python.log
python3 -c 'import ode_trimesh_gpu as otg; print(otg.__version__, otg.__file__)' | grep /usr/lib/python3/dist-packages
test -s /usr/share/doc/libode-trimesh-gpu-doc/copyright
apt-get -q -y purge '*ode-trimesh-gpu*'
! python3 -c 'import ode_trimesh_gpu' 2>/dev/null
test -z "$(find /usr -name '*ode_trimesh_gpu*' -o -name '*ode-trimesh-gpu*')"
END
  chroot "$root/debian" bash /tmp/try.sh >&2
  echo "installed, used and removed" >&2
fi
ls "$build"/*.deb
