#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Objects compiled for one instruction set offer the linker no function that others could use: it may take any one copy
# of an inline function or template for the whole program, and must not find one there that needs a newer processor.
#
#   simd_symbols.sh NM OBJECT...               of each object .../wide_kernels_SET.cpp.o, every external function has
#                                              namespace simd_SET in its name
#   simd_symbols.sh --expect NAME NM OBJECT    the breach NAME is reported (a test of this test)
set -euo pipefail

# breaches NM OBJECT: the external functions (nm's T, W and i; data hold no instructions) without that namespace.
breaches() {
  local set=${2##*/wide_kernels_}
  set=simd_${set%%.*}
  # In mangled names every part follows its length.
  "$1" --defined-only --extern-only --format=posix "$2" | awk -v own="${#set}$set" '$2 ~ /^[TWi]$/ && !index($1, own) { print $1 }'
}

if [ "$1" = --expect ]; then
  found=$(breaches "$3" "$4")
  [[ $(wc -l <<<"$found") -eq 1 && $found == *"$2"* ]] || { echo "not only the function $2 was reported, but: '$found'"; exit 1; }
  exit 0
fi

nm=$1
shift
examined=0
status=0
for object in "$@"; do
  [[ ${object##*/} == wide_kernels_*.o ]] || continue
  # The kernels themselves have to show, or the names that this test looks for are out of date.
  "$nm" --defined-only --extern-only --format=posix "$object" | grep -q 'traverseWide.* T ' ||
    { echo "no kernel found in $object"; exit 1; }
  examined=$((examined + 1))
  for function in $(breaches "$nm" "$object"); do
    echo "$object: $(c++filt "$function" 2>/dev/null || echo "$function")"
    status=1
  done
done
[ "$examined" -gt 0 ] || { echo "no objects given"; exit 1; }
exit $status
