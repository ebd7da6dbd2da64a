#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# The matrix of continuous integration, one name for each row. Each row installs what it needs, builds in build-ROW/ and ends with
# a line that says what passed.
#
#   scripts/ci.sh ROW...      some rows
#   scripts/ci.sh list        the names of all rows
#
#   gcc clang clang19     the library and its core tests by GCC 12, Clang 14 and Clang 19; warnings are errors
#   simd                  the same contacts by SSE2, AVX2 and AVX-512 (the first two under qemu-user)
#   aarch64               cross-compiled; core tests under qemu-user, the longest with a tenth of their rounds
#   mingw                 cross-compiled for Windows with ODE's source; core tests under Wine
#   single                compiles against the headers of ODE in single precision
#   subproject            inside a user's project, by add_subdirectory() and FetchContent
#   conan                 `conan create` of the recipe in packaging/conan
#   gazebo                a world of Gazebo's physics with DART and ODE (packages of 250 MB)
#   viewer                the page of a run in headless Chromium, its picture beside the one it was
#   wheel deb lint        python.sh, packages.sh --try, lint.sh
#   docs                  docs.sh --gallery, with every page in headless Chromium
#
# JOBS is how many compilers run at once (default: one for each core).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
jobs=${JOBS:-$(nproc)}
# Objects of one compiler are equal in every row: paths below this folder do not count.
export CCACHE_BASEDIR=${CCACHE_BASEDIR:-$PWD} CCACHE_NOHASHDIR=1
rows=(gcc clang clang19 simd aarch64 mingw single subproject conan gazebo viewer wheel docs deb lint)
# What reaches most of the library without devices, in a few minutes. Golden contacts are equal bytes on every machine.
core=(tests_core_asan tests_core_tsan test_contact_counts test_default_contacts)
core_labels='^(core_asan|core_tsan|golden)$'

install() { bash scripts/install_dependencies.sh "$@"; }

# build ROW TARGETS [CMake words]: configures build-ROW and builds the targets.
build() {
  local row=$1 targets=$2
  shift 2
  mkdir -p "build-$row"
  local log=build-$row/ci.log
  cmake -S . -B "build-$row" -G Ninja -DCMAKE_BUILD_TYPE=Release -DOTG_WARNINGS_AS_ERRORS=ON -DOTG_BUILD_DEMOS=OFF -DOTG_BUILD_BENCHMARKS=OFF \
    "$@" >"$log" 2>&1 || { cat "$log" >&2; return 1; }
  # shellcheck disable=SC2086  # several targets
  cmake --build "build-$row" --target $targets -- -j"$jobs" >"$log" 2>&1 || { tail -n 60 "$log" >&2; return 1; }
}

# run_core ROW [ctest words]
run_core() {
  local row=$1
  shift
  ctest --test-dir "build-$row" -j"$jobs" -L "$core_labels" -E opencl --no-tests=error --output-on-failure "$@" | tail -n 40
}

row_compiler() {
  local row=$1 cc=$2 cxx=$3
  shift 3
  build "$row" "ode_trimesh_gpu ode_trimesh_gpu_static ode_trimesh_gpu_preload otg_headers_c89 otg_headers_cxx ${core[*]}" \
    -DCMAKE_C_COMPILER="$cc" -DCMAKE_CXX_COMPILER="$cxx" "$@"
  run_core "$row"
}
row_gcc() { install tests ci_gcc && row_compiler gcc gcc-12 g++-12; }
row_clang() { install tests ci_clang && row_compiler clang clang-14 clang++-14; }
# The C++ library of GCC 12 uses for std::stable_sort() what C++17 has deprecated, which this Clang says of our call.
row_clang19() { install tests ci_clang19 && row_compiler clang19 clang-19 clang++-19 -DCMAKE_CXX_FLAGS=-Wno-error=deprecated-declarations; }

row_simd() {
  install tests ci_simd
  build gcc "${core[*]}" -DCMAKE_C_COMPILER=gcc-12 -DCMAKE_CXX_COMPILER=g++-12
  local program
  for program in wide_kernels default_contacts contact_counts; do
    echo "-- $program: SSE2"
    qemu-x86_64 -cpu qemu64 "build-gcc/bin/test_$program"
    echo "-- $program: AVX2"
    qemu-x86_64 -cpu max "build-gcc/bin/test_$program"
    echo "-- $program: this processor$(grep -qw avx512vl /proc/cpuinfo && echo ' (AVX-512)' || echo ' (AVX-512 skipped: it has none)')"
    "build-gcc/bin/test_$program"
  done
}

# ode_from_source ROW: Debian's source of ODE, compiled for the row as an archive, and what else it needs, in build-ROW-root.
ode_from_source() {
  local row=$1 root=$PWD/build-$1-root source=$PWD/build-ode-source
  # Headers that a cross compiler must not take from /usr/include, as packages without archives of this machine.
  mkdir -p "$root/include" "$root/lib/cmake/Catch2" "$root/lib/cmake/fmt" "$root/lib/cmake/nlohmann_json" "$root/lib/cmake/CLI11" "$root/lib/pkgconfig" "$root/share"
  cp -r /usr/include/catch2 /usr/include/fmt /usr/include/nlohmann /usr/include/CLI /usr/include/CL /usr/include/eigen3 "$root/include/"
  cp -r /usr/share/eigen3 "$root/share/"
  local package name
  for package in Catch2:Catch2::Catch2 fmt:fmt::fmt nlohmann_json:nlohmann_json::nlohmann_json CLI11:CLI11::CLI11; do
    name=${package%%:*}
    cat >"$root/lib/cmake/$name/${name}Config.cmake" <<END
add_library(${package#*:} INTERFACE IMPORTED)
set_target_properties(${package#*:} PROPERTIES INTERFACE_COMPILE_DEFINITIONS FMT_HEADER_ONLY INTERFACE_INCLUDE_DIRECTORIES "$root/include")
set(Catch2_VERSION 2.13)
END
  done
  [ ! -s "$root/lib/pkgconfig/ode.pc" ] || return 0
  if [ ! -d "$source/ode" ]; then
    mkdir -p "$source/lists/partial"
    # A list of packages of its own: the machine's need not know sources.
    # shellcheck source=/dev/null
    (. /etc/os-release && echo "deb-src http://deb.debian.org/debian $VERSION_CODENAME main") >"$source/sources.list"
    local apt=(-q -o "Dir::Etc::SourceList=$source/sources.list" -o Dir::Etc::SourceParts=/nonexistent
      -o "Dir::State::Lists=$source/lists" -o "Dir::Cache=$source")
    apt-get "${apt[@]}" update >&2
    (cd "$source" && apt-get "${apt[@]}" source --download-only ode >&2)
    mkdir "$source/part"
    tar -x -C "$source/part" --strip-components=1 -f "$source"/ode_*.orig.tar.gz
    mv "$source/part" "$source/ode"
  fi
  echo '#include <windows.h>' >"$root/include/Windows.h"  # ODE writes it so; files of MinGW are in small letters
  cmake -S "$source/ode" -B "$root/ode" -G Ninja -DCMAKE_TOOLCHAIN_FILE="$PWD/cmake/toolchains/$row.cmake" -DCMAKE_BUILD_TYPE=Release \
    -DBUILD_SHARED_LIBS=OFF -DCMAKE_POSITION_INDEPENDENT_CODE=ON -DODE_WITH_DEMOS=OFF -DODE_WITH_TESTS=OFF -DODE_WITH_LIBCCD=ON \
    -DCMAKE_C_FLAGS=-w "-DCMAKE_CXX_FLAGS=-w -I$root/include" -DCMAKE_INSTALL_PREFIX="$root" >"$root/ode.log" 2>&1 &&
    cmake --build "$root/ode" --target install -- -j"$jobs" >"$root/ode.log" 2>&1 || { tail -n 40 "$root/ode.log" >&2; return 1; }
  # ODE writes no file for pkg-config where the target is Windows.
  name=$(basename "$(ls "$root"/lib/libode*.a)" .a)
  printf 'Name: ode\nDescription: ODE\nVersion: 0.16.2\nLibs: -L%s/lib -l%s -lstdc++ -lm\nCflags: -I%s/include -DdIDEDOUBLE -DODE_LIB\n' \
    "$root" "${name#lib}" "$root" >"$root/lib/pkgconfig/ode.pc"
}

# cross ROW TARGETS [CMake words]: builds with the toolchain file of that name.
cross() {
  local row=$1 targets=$2
  shift 2
  ode_from_source "$row"
  PKG_CONFIG_LIBDIR=$PWD/build-$row-root/lib/pkgconfig build "$row" "$targets" "$@" \
    -DCMAKE_TOOLCHAIN_FILE="$PWD/cmake/toolchains/$row.cmake" -DCMAKE_FIND_ROOT_PATH="$PWD/build-$row-root" \
    -DOTG_OPENCL_INCLUDE_DIR="$PWD/build-$row-root/include"
}
# Not the library to preload: ODE is an archive here.
row_aarch64() {
  install tests ci_aarch64
  cross aarch64 "ode_trimesh_gpu ${core[*]}"
  OTG_TEST_PART=0.1 run_core aarch64 --timeout 3000
}
row_mingw() {
  install tests ci_mingw
  # ODE's type of message functions says how they print, which a template argument loses: nothing is lost by that.
  cross mingw "ode_trimesh_gpu ${core[*]}" -DCMAKE_CXX_FLAGS=-Wno-error=ignored-attributes
  # Not below this folder: it has a link to /, which what walks the sources would follow.
  local prefix result=0
  prefix=$(mktemp -d)
  export WINEPREFIX=$prefix WINEDEBUG=-all
  # Two tests that make the prefix at once may fail.
  "$(sed -n 's/^OTG_WINE:[^=]*=//p' build-mingw/CMakeCache.txt)" wineboot --init
  run_core mingw --timeout 3000 || result=$?
  rm -rf "$prefix"
  return $result
}

row_single() {
  install
  # Debian's headers, with the other precision. There is no library to link with: objects alone.
  rm -rf build-single-root
  mkdir -p build-single-root/lib
  cp -r /usr/include/ode build-single-root/
  printf 'Name: ode\nDescription: ODE\nVersion: 0.16.2\nCflags: -I%s -DdIDESINGLE\n' "$PWD/build-single-root" >build-single-root/lib/ode.pc
  PKG_CONFIG_PATH=$PWD/build-single-root/lib build single "otg_ode otg_headers_c89 otg_headers_cxx" \
    -DCMAKE_BUILD_TYPE=Debug -DCMAKE_OPTIMIZE_DEPENDENCIES=ON  # without the layers below, which do not include ODE
  grep -q dIDESINGLE build-single/build.ninja
}

row_subproject() { install && bash tests/robustness/subproject/run.sh "$PWD" "$PWD/build-subproject" --build; }

row_conan() {
  install ci_conan
  [ -x build-conan-tools/bin/conan ] || { python3 -m venv build-conan-tools && build-conan-tools/bin/pip install -q --disable-pip-version-check 'conan>=2.4,<3'; }
  export CONAN_HOME=$PWD/build-conan
  build-conan-tools/bin/conan profile detect --force >/dev/null 2>&1
  build-conan-tools/bin/conan create packaging/conan -s compiler.cppstd=20 -c tools.build:jobs="$jobs" \
    -c tools.cmake.cmake_layout:test_folder="$CONAN_HOME/test" 2>&1 | tail -n 30
}

row_gazebo() {
  install tests ci_gazebo
  cmake --preset default >/dev/null
  cmake --build build --target ode_trimesh_gpu_preload demo_drop_in_gazebo demo_drop_in_dart -- -j"$jobs" >build/gazebo.log 2>&1 ||
    { tail -n 40 build/gazebo.log >&2; return 1; }
  ctest --test-dir build --no-tests=error --output-on-failure -R '^robustness.drop_in_(gazebo|dart)$' | tail -n 12
}

row_viewer() {
  install viewer
  cmake --preset default >/dev/null
  cmake --build build --target otg -- -j"$jobs" >build/viewer.log 2>&1 || { tail -n 40 build/viewer.log >&2; return 1; }
  ctest --test-dir build --no-tests=error --output-on-failure -R '^robustness.viewer$' | tee build/viewer.log | tail -n 12
  ! grep -q Skipped build/viewer.log
}

row_wheel() { bash scripts/python.sh; }
row_docs() { install viewer && bash scripts/docs.sh --gallery; }
row_deb() { bash scripts/packages.sh --try; }
row_lint() { install lint && bash scripts/lint.sh; }

[ $# -gt 0 ] || { sed -n '3,/^set/{/^set/d;s/^# \{0,1\}//;p}' "$0"; exit 2; }
if [ "$1" = list ]; then
  printf '%s\n' "${rows[@]}"
  exit 0
fi
failed=()
for row in "$@"; do
  if [[ " ${rows[*]} " != *" $row "* ]]; then
    echo "$0: no row '$row' (${rows[*]})" >&2
    exit 2
  fi
  echo "== $row"
  start=$SECONDS
  # A shell of its own: `set -e` does not work within a condition.
  set +e
  (set -e; "row_$row")
  result=$?
  set -e
  if [ $result -eq 0 ]; then
    echo "$row: passed in $((SECONDS - start)) s"
  else
    echo "$row: FAILED after $((SECONDS - start)) s" >&2
    failed+=("$row")
  fi
done
[ ${#failed[@]} -eq 0 ] || { echo "failed: ${failed[*]}" >&2; exit 1; }
