#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Checks the sources without running them: clang-format on all of them, clang-tidy (the checks of .clang-tidy) on the
# library, the harness, the benchmarks and the demos. Made for the versions of Debian 12, 14 both. That is some 370
# files, each of which takes seconds to a minute, so no test runs it.
#
#   scripts/lint.sh                   everything
#   scripts/lint.sh FILE.cpp...       only these
#
# Exit status 0 if nothing was found. Installs what is missing first: see install_dependencies.sh.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

bash scripts/install_dependencies.sh lint

if [ $# -gt 0 ]; then
  formatted=("$@")
  tidied=("$@")
else
  mapfile -t formatted < <(git ls-files '*.c' '*.cpp' '*.h' '*.hpp')
  mapfile -t tidied < <(git ls-files 'ode_trimesh_gpu/*.cpp' 'harness/*.cpp' 'benchmarks/*.cpp' 'demos/*.cpp')
fi

status=0
echo "== clang-format: ${#formatted[@]} files"
clang-format --dry-run -Werror "${formatted[@]}" || status=1

echo "== clang-tidy: ${#tidied[@]} files"
# In a folder of its own, in which every file has a compile command: no sources are compiled together.
cmake --preset default -B build-lint -DCMAKE_UNITY_BUILD=OFF >/dev/null
# What is left out of a build (a library that is not installed) has no compile command and can't be examined.
compiled=()
for file in "${tidied[@]}"; do
  if grep -qF "/$file\"" build-lint/compile_commands.json; then
    compiled+=("$file")
  else
    echo "left out, because it is not compiled here: $file"
  fi
done
printf '%s\0' "${compiled[@]}" | xargs -0 -n 1 -P "$(nproc)" clang-tidy -p build-lint --quiet 2>/dev/null || status=1
exit $status
