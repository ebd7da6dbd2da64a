#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs the build tree, moves what was installed, and builds and runs a user's C and C++ program against it: with CMake
# and with pkg-config, with the shared library and with the archive. Also compiles every installed header alone.
#
#   run.sh CMAKE BUILD_DIR SOURCE_DIR SCRATCH_DIR CC CXX GENERATOR MAKE_PROGRAM
set -euo pipefail

cmake=$1 build=$2 source=$3 scratch=$4 cc=$5 cxx=$6 generator=$7 make=$8
here=$source/tests/robustness/installed_package
strict=(-Wall -Wextra -Wpedantic -Werror)

step() { echo "== $*"; }
fail() {
  echo "FAILED: $*"
  exit 1
}

rm -rf "$scratch"
mkdir -p "$scratch"
step "install, then move: nothing in the package may depend on where it was put"
"$cmake" --install "$build" --prefix "$scratch/first" >/dev/null
mv "$scratch/first" "$scratch/moved"
prefix=$scratch/moved
if grep -rlF -e "$build" -e "$source" -e "$scratch/first" "$prefix" --include='*.cmake' --include='*.pc' --include='*.h*'; then
  fail "the files above name a folder of the build"
fi

step "what is installed beside the library"
for file in LICENSE CHANGELOG.md docs/getting_started.md examples/first_steps.c; do
  [ -s "$prefix/share/doc/ode_trimesh_gpu/$file" ] || fail "$file is missing"
done
if [ -s "$prefix/share/man/man1/otg.1" ]; then
  grep -q -- '\\-\\-html' "$prefix/share/man/man1/otg.1" || fail "the manual page says nothing of --html"
fi

step "symbols have the version of the SONAME"
library=$(find "$prefix" -name 'libode_trimesh_gpu.so')
soname=$(objdump -p "$library" | awk '$1 == "SONAME" { print $2 }')
objdump -T "$library" | awk '/\.text/ && / d[A-Z]/ { print $(NF - 1) }' | sort -u >"$scratch/versions"
[ "$(cat "$scratch/versions")" = "ODE_TRIMESH_GPU_${soname#libode_trimesh_gpu.so.}" ] || fail "$soname has the symbol versions $(cat "$scratch/versions")"

step "what was not built is not installed, and the rest is (as after scripts/demo.sh)"
sed -e "s#$build/bin/otg_bench#$scratch/not_built#g" "$build/packaging/cmake_install.cmake" >"$scratch/partial.cmake"
"$cmake" -DCMAKE_INSTALL_PREFIX="$scratch/partial" -P "$scratch/partial.cmake" >/dev/null || fail "cmake --install without otg_bench"
[ -e "$scratch/partial/lib/libode_trimesh_gpu.a" ] || fail "the archive is missing"
[ ! -e "$scratch/partial/bin/otg_bench" ] || fail "otg_bench was installed though it was not built"

step "components"
"$cmake" --install "$build" --prefix "$scratch/component" --component preload >/dev/null
[ "$(find "$scratch/component" -type f | wc -l)" -eq 1 ] || fail "the component preload is more than one file"

step "the README's lines"
awk '/^```c$/ { on = 1; next } /^```$/ { on = 0 } on' "$source/README.md" >"$scratch/readme_snippet.h"
grep -q dCreateGpuTriMesh "$scratch/readme_snippet.h" || fail "README.md has no block of C with dCreateGpuTriMesh"

step "every installed header alone, as C and as C++"
found=0
while read -r header; do
  found=$((found + 1))
  name=${header#"$prefix/include/"}
  printf '#include <%s>\ntypedef int a_file_is_not_empty;\n' "$name" >"$scratch/header.c"
  cp "$scratch/header.c" "$scratch/header.cpp"
  if [ "${header##*.}" = h ]; then
    # C89 as far as our own headers go: ODE's are system headers, in which the compiler lets more pass.
    "$cc" -std=c89 "${strict[@]}" -I"$prefix/include" -fsyntax-only "$scratch/header.c"
  fi
  "$cxx" -std=c++11 "${strict[@]}" -I"$prefix/include" -fsyntax-only "$scratch/header.cpp"
done < <(find "$prefix/include" -name '*.h' -o -name '*.hpp')
[ "$found" -gt 0 ] || fail "no header was installed"

step "CMake"
"$cmake" -S "$here" -B "$scratch/cmake" -G "$generator" -DCMAKE_MAKE_PROGRAM="$make" -DCMAKE_PREFIX_PATH="$prefix" -DSNIPPET_DIR="$scratch" \
  -DCMAKE_C_COMPILER="$cc" -DCMAKE_CXX_COMPILER="$cxx" -DCMAKE_BUILD_TYPE=Debug >"$scratch/cmake.log" ||
  { cat "$scratch/cmake.log"; fail "find_package"; }
"$cmake" --build "$scratch/cmake" >"$scratch/build.log" || { cat "$scratch/build.log"; fail "building with CMake"; }
for program in c_shared c_static cpp_shared cpp_static; do
  "$scratch/cmake/$program" || fail "$program (CMake)"
done

step "CMake, a project in C alone"
mkdir "$scratch/c_alone"
cat >"$scratch/c_alone/CMakeLists.txt" <<END
cmake_minimum_required(VERSION 3.22)
project(otg_package_user LANGUAGES C)
find_package(ode_trimesh_gpu 0.1 REQUIRED)
add_executable(c_alone "$here/main.c")
target_include_directories(c_alone PRIVATE "$scratch")
target_link_libraries(c_alone PRIVATE ode_trimesh_gpu::ode_trimesh_gpu_static)
END
{ "$cmake" -S "$scratch/c_alone" -B "$scratch/c_alone/build" -G "$generator" -DCMAKE_MAKE_PROGRAM="$make" -DCMAKE_PREFIX_PATH="$prefix" \
    -DCMAKE_C_COMPILER="$cc" && "$cmake" --build "$scratch/c_alone/build"; } >"$scratch/c_alone.log" 2>&1 ||
  { cat "$scratch/c_alone.log"; fail "a project in C alone, static"; }
"$scratch/c_alone/build/c_alone" || fail "c_alone"

step "pkg-config"
pc=$(dirname "$(find "$prefix" -name ode_trimesh_gpu.pc)")
libdir=$(dirname "$pc")
export PKG_CONFIG_PATH=$pc
pkg-config --print-errors --exists 'ode_trimesh_gpu >= 0.1' || fail "pkg-config does not find the package"
read -ra cflags <<<"$(pkg-config --cflags ode_trimesh_gpu)"
read -ra shared <<<"$(pkg-config --libs ode_trimesh_gpu)"
# The archive in place of -lode_trimesh_gpu, everything else as pkg-config has it for static linking.
read -ra static <<<"$(pkg-config --static --libs ode_trimesh_gpu | sed 's/-lode_trimesh_gpu/-l:libode_trimesh_gpu.a/')"
"$cc" -std=c99 -I"$scratch" "${cflags[@]}" "$here/main.c" -o "$scratch/pc_c_shared" "${shared[@]}"
"$cc" -std=c99 -I"$scratch" "${cflags[@]}" "$here/main.c" -o "$scratch/pc_c_static" "${static[@]}"
"$cxx" -std=c++11 "${cflags[@]}" "$here/main.cpp" -o "$scratch/pc_cpp_shared" "${shared[@]}"
"$cxx" -std=c++11 "${cflags[@]}" "$here/main.cpp" -o "$scratch/pc_cpp_static" "${static[@]}"
for program in pc_c_shared pc_cpp_shared; do
  LD_LIBRARY_PATH=$libdir "$scratch/$program" || fail "$program"
done
for program in pc_c_static pc_cpp_static; do
  "$scratch/$program" || fail "$program"  # no path to the shared library: the archive is really inside
done

echo "ok"
