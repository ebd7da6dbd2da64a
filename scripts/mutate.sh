#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Breaks a line of the library or its kernels in random places, one at a time, and lists the changes that no test notices
# (folder build-mutate/). Works on a copy of the committed sources.
#
#   scripts/mutate.sh                 200 changes
#   scripts/mutate.sh 20              20
#   scripts/mutate.sh 20 1000         20, the first drawn with seed 1000
#
# A change that does not compile, or that changes nothing (a bound that no value meets), tells nothing: look at each
# survivor. Each takes a build and, unless a test fails at once, all unit, golden and simulator tests; changes of kernels
# and of what talks to devices take the parity tests, too.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

count=${1:-200}
seed=${2:-1}
jobs=$(nproc)
mkdir -p build-mutate
tree=$PWD/build-mutate/tree
rm -rf "$tree"
mkdir -p "$tree"
git archive HEAD | tar -x -C "$tree"
cmake -S "$tree" -B build-mutate/build -G Ninja -DCMAKE_BUILD_TYPE=Release -DOTG_BUILD_BENCHMARKS=OFF >/dev/null
targets=(tests_unit tests_golden tests_parity)
cmake --build build-mutate/build --target "${targets[@]}" -- -j"$jobs" >build-mutate/build.log

# run_tests LABELS: whether all pass; stops at the first that fails. A test that hangs fails.
run_tests() {
  ctest --test-dir build-mutate/build -j"$jobs" -L "$1" --stop-on-failure --timeout 300 >build-mutate/test.log 2>&1
}
if ! run_tests '^(unit|golden)$'; then
  echo "tests fail without a change: see build-mutate/test.log" >&2
  exit 1
fi

survivors=0
done_=0
while [ "$done_" -lt "$count" ]; do
  change=$(python3 scripts/mutate.py "$tree" "$seed") || { seed=$((seed + 1)); continue; }
  file=${change%%:*}
  labels='^(unit|golden)$'
  case "$file" in kernels/* | ode_trimesh_gpu/opencl/* | ode_trimesh_gpu/dispatch/*) labels='^(unit|golden|parity)$' ;; esac
  if ! cmake --build build-mutate/build --target "${targets[@]}" -- -j"$jobs" >build-mutate/build.log 2>&1; then
    verdict="does not compile"
  elif run_tests "$labels"; then
    verdict=SURVIVES
    survivors=$((survivors + 1))
  else
    verdict="noticed by $(sed -n 's/.*Test *#[0-9]*: \([^ ]*\) .*Failed.*/\1/p;s/.*Test *#[0-9]*: \([^ ]*\) .*\(Timeout\|Exception\).*/\1/p' build-mutate/test.log | head -1)"
  fi
  [ "$verdict" = "does not compile" ] || done_=$((done_ + 1))
  printf '%s\t%s\t%s\n' "$seed" "$verdict" "$change" | tee -a build-mutate/changes.txt
  git show "HEAD:$file" >"$tree/$file"
  seed=$((seed + 1))
done
echo "$done_ changes, $survivors survivors"
