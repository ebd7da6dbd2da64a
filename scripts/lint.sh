#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Checks the sources without running them: clang-format on all of C and C++, clang-tidy (the checks of .clang-tidy) on the
# library, the harness, the benchmarks and the demos, ruff (the rules of pyproject.toml) on Python. Made for the versions
# of Debian 12, 14 both, and for the version of ruff below, which comes from PyPI. clang-tidy reads some 370 files, each
# of which takes seconds to a minute, so no test runs it.
#
#   scripts/lint.sh                   everything
#   scripts/lint.sh FILE...           only these
#
# Exit status 0 if nothing was found. Installs what is missing first: see install_dependencies.sh.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

ruff_version=0.17.6

bash scripts/install_dependencies.sh lint

formatted=() tidied=() python=()
if [ $# -gt 0 ]; then
  for file in "$@"; do
    case "$file" in
      *.py) python+=("$file") ;;
      *) formatted+=("$file") tidied+=("$file") ;;
    esac
  done
else
  mapfile -t formatted < <(git ls-files '*.c' '*.cpp' '*.h' '*.hpp')
  mapfile -t tidied < <(git ls-files 'ode_trimesh_gpu/*.cpp' 'harness/*.cpp' 'benchmarks/*.cpp' 'demos/*.cpp')
  mapfile -t python < <(git ls-files '*.py')
fi

status=0
if [ ${#python[@]} -gt 0 ]; then
  tools=build-lint-tools
  [ -x $tools/bin/pip ] || python3 -m venv $tools
  $tools/bin/pip install -q --disable-pip-version-check "ruff==$ruff_version"
  echo "== ruff: ${#python[@]} files"
  $tools/bin/ruff check --quiet --no-cache "${python[@]}" || status=1
fi
[ ${#formatted[@]} -gt 0 ] || exit $status

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
