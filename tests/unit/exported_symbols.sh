#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# exported_symbols.sh NM LIBRARY INCLUDE_DIR VERSION: the shared library shows exactly the functions that the public headers
# declare, each with the version of symbols ODE_TRIMESH_GPU_VERSION.
set -euo pipefail
nm=$1 library=$2 include=$3 version=ODE_TRIMESH_GPU_$4
# Clang builds take llvm-nm, and that of LLVM 14 does not know versions.
"$nm" --with-symbol-versions --version >/dev/null 2>&1 || nm=nm
shown=$("$nm" --dynamic --defined-only --format=posix --with-symbol-versions "$library" | awk -v version="$version" \
  '$1 != version { sub("@@" version "$", "", $1); print $1 }' | sort -u)
declared=$(cat "$include"/ode_trimesh_gpu/*.h | grep -A1 'OTG_API' | grep -oE '\b(dCreateGpuTriMesh|dGpuTriMesh|dGeomGpuTriMesh|dMassSetGpuTriMesh)[A-Za-z0-9]*\(' | tr -d '(' | sort -u)
[ "$(wc -l <<<"$declared")" -gt 40 ] || { echo "the headers could not be read"; exit 1; }
if ! diff <(echo "$declared") <(echo "$shown"); then
  echo "< declared but not shown, > shown but not declared"
  exit 1
fi
