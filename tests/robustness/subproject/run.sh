#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# This project inside another one, by add_subdirectory() and by FetchContent.
#
#   run.sh SOURCE SCRATCH            configures both, which finds most faults in seconds
#   run.sh SOURCE SCRATCH --build    also builds and runs a user's program, shared and static: compiles the library twice
set -euo pipefail
source=$1 scratch=$2
rm -rf "$scratch"
mkdir -p "$scratch"
awk '/^```c$/ { on = 1; next } /^```$/ { on = 0 } on' "$source/README.md" >"$scratch/readme_snippet.h"
for way in subdirectory fetch; do
  echo "== $way"
  build=$scratch/$way
  cmake -S "$source/tests/robustness/subproject" -B "$build" -G Ninja -DWAY=$way -DOTG_SOURCE="$source" -DSNIPPET_DIR="$scratch" \
    -DCMAKE_BUILD_TYPE=Release >"$scratch/$way.log" 2>&1 || { cat "$scratch/$way.log"; exit 1; }
  # The user's own files are compiled without this project's flags.
  if ninja -C "$build" -t commands user | grep 'main\.c' | grep -qE 'Wpedantic|Werror|ffp-contract'; then
    echo "FAILED: flags of this project reach the user's files"
    exit 1
  fi
  [ "${3:-}" = --build ] || continue
  cmake --build "$build" --target user user_static
  # Programs lie where the project that builds them says.
  for program in user user_static; do
    "$build/$program"
  done
done
echo "ok"
