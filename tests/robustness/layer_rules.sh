#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Rules of the source tree that no compiler checks. Prints every breach; exit status 1 if there is one.
#
#   layer_rules.sh ROOT              checks the tree at ROOT
#   layer_rules.sh --self-test DIR   makes small trees below DIR that break each rule once, and expects each to be reported
set -euo pipefail

kMaxLines=600

# check ROOT: one line per breach on stdout.
check() {
  local root=$1 folders=() folder
  cd "$root"
  for folder in ode_trimesh_gpu kernels harness benchmarks demos tests examples; do
    [ ! -d "$folder" ] || folders+=("$folder")
  done
  list_sources() { find "${folders[@]}" -type f \( -name '*.h' -o -name '*.hpp' -o -name '*.c' -o -name '*.cpp' -o -name '*.cl' -o -name '*.inc' \); }
  # rule MESSAGE REGEX FOLDER...: no file of these folders has a line that matches.
  rule() {
    local message=$1 regex=$2 existing=() place
    shift 2
    for place in "$@"; do [ ! -d "$place" ] || existing+=("$place"); done
    [ ${#existing[@]} -eq 0 ] || grep -rnE "$regex" "${existing[@]}" | sed "s|^|$message: |" || true
  }
  local inc='^[[:space:]]*#[[:space:]]*include[[:space:]]*[<"]'
  local lib=ode_trimesh_gpu
  # ode_trimesh_gpu/ is the public interface, which belongs to ode/.
  rule "only ode/ knows ODE" "${inc}(ode|ode_trimesh_gpu)/" $lib/base $lib/mesh $lib/bvh $lib/collide $lib/primitives $lib/queries $lib/opencl $lib/dispatch kernels
  rule "only opencl/ knows OpenCL" "${inc}(CL|OpenCL)/" $lib/base $lib/mesh $lib/bvh $lib/collide $lib/primitives $lib/queries $lib/dispatch $lib/ode $lib/include kernels
  rule "base/ is below every other layer" "${inc}(mesh|bvh|collide|primitives|queries|opencl|dispatch)/" $lib/base
  rule "mesh/ is below all but base/" "${inc}(bvh|collide|primitives|queries|opencl|dispatch)/" $lib/mesh
  rule "bvh/ is below collide/" "${inc}(collide|primitives|queries|opencl|dispatch)/" $lib/bvh
  rule "collide/ is below opencl/" "${inc}(primitives|queries|opencl|dispatch)/" $lib/collide
  rule "primitives/ and queries/ know collide/ and what is below" "${inc}(opencl|dispatch)/" $lib/primitives $lib/queries
  rule "opencl/ is below dispatch/" "${inc}dispatch/" $lib/opencl
  rule "the public headers need nothing of the inside" "${inc}(base|mesh|bvh|collide|primitives|queries|opencl|dispatch|shared)/" $lib/include
  rule "kernels include kernels and shared formulas only" "${inc}(base|mesh|bvh|collide|primitives|opencl|dispatch|Eigen)/" kernels
  rule "shared formulas include shared formulas only" "${inc%\[*}\"([^s]|s[^h])" kernels/shared
  # Those who measure it, tests and demos, may look in.
  rule "the library reaches opencl/published/ in one place" "${inc}opencl/published/" $lib |
    grep -vE ": $lib/opencl/(published/[^:]*|backend_published\.cpp):" || true
  rule "nothing else includes kernels/published/" "${inc}published/" kernels | grep -vF ": kernels/published/" || true
  # What lies around the library, each by the folders in it: harness <- benchmarks, harness <- demos, and tests on top.
  local harness='scenes|mesh_io|truth|cli' benchmarks='otg_bench|physics|peers|published'
  local demos='otg|falling_meshes|drop_in|prefetch' tests='support|oracle|simulator'
  rule "the library knows nothing of what lies around it" "${inc}($harness|$benchmarks|$demos|$tests)/" $lib kernels
  rule "harness/ is below benchmarks, demos and tests" "${inc}($benchmarks|$demos|$tests)/" harness
  rule "benchmarks/ know harness/ and the library" "${inc}($demos|$tests)/" benchmarks
  rule "demos/ know harness/ and the library" "${inc}($benchmarks|$tests)/" demos
  rule "examples/ know the public interface" "${inc}(base|mesh|bvh|collide|primitives|queries|opencl|dispatch|shared|$harness|$benchmarks|$demos|$tests)/" examples
  rule "includes name a layer, not a way through the file system" "${inc}[^>\"]*\.\./" "${folders[@]}"
  rule "the library does not print" '\b(printf|fprintf|puts|perror)[[:space:]]*\(|std::(cout|cerr|clog)\b' $lib/base $lib/mesh $lib/bvh $lib/collide $lib/primitives $lib/queries $lib/dispatch
  rule "the library does not end the process" '\b(std::)?(abort|exit|_exit|quick_exit)[[:space:]]*\(' $lib
  rule "the environment is read in one place" '\bgetenv[[:space:]]*\(' $lib harness benchmarks demos |
    grep -vF ": $lib/base/environment.cpp:" || true
  local file lines
  while read -r file; do
    lines=$(wc -l <"$file")
    [ "$lines" -le $kMaxLines ] || echo "a file is $kMaxLines lines at most: $file: $lines"
    [ "$(head -n 1 "$file" | grep -c 'SPDX-License-Identifier: BSD-3-Clause')" -eq 1 ] ||
      echo "the first line names the licence: $file:1"
  done < <(list_sources)
}

# expect DIR NAME FILE CONTENT: a tree with this one file is reported, and the report names the file.
expect() {
  local tree=$1/$2
  mkdir -p "$tree/$(dirname "$3")"
  printf '%b' "$4" >"$tree/$3"
  if ! (check "$tree") | grep -qF "$3"; then
    echo "self-test: the breach '$2' was not reported"
    return 1
  fi
}

self_test() {
  local dir=$1 spdx='// SPDX-License-Identifier: BSD-3-Clause\n' many place
  rm -rf "$dir"
  expect "$dir" ode_in_mesh ode_trimesh_gpu/mesh/a.cpp "$spdx#include <ode/ode.h>\n"
  expect "$dir" api_in_collide ode_trimesh_gpu/collide/a.h "$spdx#include \"ode_trimesh_gpu/ode_trimesh_gpu.h\"\n"
  expect "$dir" cl_in_bvh ode_trimesh_gpu/bvh/a.cpp "$spdx#  include <CL/cl.h>\n"
  expect "$dir" cl_in_ode ode_trimesh_gpu/ode/a.cpp "$spdx#include <CL/opencl.hpp>\n"
  expect "$dir" upwards ode_trimesh_gpu/mesh/a.h "$spdx#include \"collide/query.h\"\n"
  expect "$dir" bvh_upwards ode_trimesh_gpu/bvh/a.h "$spdx#include \"collide/query.h\"\n"
  expect "$dir" queries_upwards ode_trimesh_gpu/queries/a.cpp "$spdx#include \"opencl/backend.h\"\n"
  expect "$dir" ode_in_primitives ode_trimesh_gpu/primitives/a.cpp "$spdx#include <ode/ode.h>\n"
  expect "$dir" opencl_upwards ode_trimesh_gpu/opencl/a.cpp "$spdx#include \"dispatch/dispatcher.h\"\n"
  expect "$dir" public_inside ode_trimesh_gpu/include/ode_trimesh_gpu/a.h "$spdx#include \"mesh/tri_mesh.h\"\n"
  expect "$dir" kernel_host kernels/shared/a.h "$spdx#include \"mesh/tri_mesh.h\"\n"
  expect "$dir" base_upwards ode_trimesh_gpu/base/a.h "$spdx#include \"mesh/tri_mesh.h\"\n"
  expect "$dir" kernel_in_shared kernels/shared/math/a.h "$spdx#include \"walk/pair_walk.h\"\n"
  expect "$dir" published ode_trimesh_gpu/opencl/lanes/a.h "$spdx#include \"opencl/published/levels.h\"\n"
  expect "$dir" published_dispatch ode_trimesh_gpu/dispatch/a.cpp "$spdx#include \"opencl/published/levels.h\"\n"
  expect "$dir" published_kernel kernels/walk/a.cl "$spdx#include \"published/levels_scan.cl\"\n"
  expect "$dir" harness_upwards harness/scenes/a.h "$spdx#include \"physics/scene.h\"\n"
  expect "$dir" published_upwards harness/cli/a.h "$spdx#include \"published/levels.h\"\n"
  expect "$dir" harness_in_library ode_trimesh_gpu/ode/geom/a.cpp "$spdx#include \"scenes/simulation.h\"\n"
  expect "$dir" benchmarks_in_library ode_trimesh_gpu/dispatch/a.cpp "$spdx#include \"peers/peer.h\"\n"
  expect "$dir" benchmarks_upwards benchmarks/physics/a.cpp "$spdx#include \"otg/commands.h\"\n"
  expect "$dir" tests_in_benchmarks benchmarks/peers/a.cpp "$spdx#include \"support/catch.h\"\n"
  expect "$dir" benchmarks_in_demos demos/otg/a.cpp "$spdx#include \"otg_bench/bench.h\"\n"
  expect "$dir" physics_in_demos demos/prefetch/a.c "$spdx#include \"physics/scene.h\"\n"
  expect "$dir" tests_in_demos demos/otg/a.h "$spdx#include \"support/draw.h\"\n"
  expect "$dir" inside_in_examples examples/a.c "$spdx#include \"collide/query.h\"\n"
  expect "$dir" dotdot tests/unit/a.cpp "$spdx#include \"../support/catch.h\"\n"
  expect "$dir" prints ode_trimesh_gpu/collide/a.cpp "${spdx}void f() { std::cerr << 1; }\n"
  expect "$dir" exits ode_trimesh_gpu/ode/a.cpp "${spdx}void f() { std::abort(); }\n"
  expect "$dir" reads_environment ode_trimesh_gpu/dispatch/a.cpp "${spdx}auto x = std::getenv(\"OTG_X\");\n"
  many=$(printf '\\n%.0s' $(seq $kMaxLines))
  expect "$dir" long demos/a.cpp "$spdx$many"
  expect "$dir" licence kernels/a.cl "// no licence\n"
  mkdir -p "$dir/clean/ode_trimesh_gpu/ode" "$dir/clean/ode_trimesh_gpu/opencl/published"
  for place in opencl/backend_published.cpp opencl/published/b.h; do
    printf '%b' "$spdx#include \"opencl/published/levels.h\"\n" >"$dir/clean/ode_trimesh_gpu/$place"
  done
  printf '%b' "$spdx#include <ode/ode.h>\n#include \"collide/query.h\"\n" >"$dir/clean/ode_trimesh_gpu/ode/a.cpp"
  if [ -n "$(check "$dir/clean")" ]; then
    echo "self-test: a clean tree was reported"
    return 1
  fi
}

if [ "${1:-}" = --self-test ]; then
  self_test "$2"
  exit 0
fi
breaches=$(check "$1")
[ -z "$breaches" ] || { echo "$breaches"; exit 1; }
