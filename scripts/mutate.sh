#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Breaks a line of the library or its kernels in random places, one at a time, and lists the changes that no test notices
# (folder build-mutate/). Works on copies of the committed sources, one for each core.
#
#   scripts/mutate.sh                    200 changes
#   scripts/mutate.sh 20                 20
#   scripts/mutate.sh 20 1000            20, the first drawn with seed 1000
#   scripts/mutate.sh 20 1000 '/collide/'  20 in files whose path has this pattern
#
# A change that does not compile, or that changes nothing (a bound that no value meets), tells nothing: look at each
# survivor. Each takes a build and, unless a test fails at once, all unit and golden tests, the quick ones first; changes of
# kernels and of what talks to devices take the parity tests, too. Each core sees its copy at the same path, by a mount of
# its own (unshare), so that nothing is built twice.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

count=${1:-200}
seed=${2:-1}
pattern=${3:-}
workers=$(nproc)
here=$PWD/build-mutate/here
tree=$here/tree
build=$here/build
targets=(tests_unit tests_golden)

# run_tests CTEST_WORDS...: whether all pass; stops at the first that fails. A test that hangs fails.
run_tests() {
  ctest --test-dir "$build" --no-tests=error --stop-on-failure --timeout 300 "$@" >"$here/test.log" 2>&1
}

# work NUMBER: the changes of one core, in the copy that is mounted at `here`.
work() {
  local draw=$((seed + $1)) mine=0 change file verdict
  while [ "$mine" -lt $(((count + workers - 1 - $1) / workers)) ]; do
    change=$(python3 scripts/mutate.py "$tree" "$draw" "$pattern") || { draw=$((draw + workers)); continue; }
    file=${change%%:*}
    local last=("${targets[@]}")
    case "$file" in kernels/* | ode_trimesh_gpu/opencl/* | ode_trimesh_gpu/dispatch/*) last+=(tests_parity) ;; esac
    if ! cmake --build "$build" --target "${last[@]}" -- -j1 >"$here/build.log" 2>&1; then
      verdict="does not compile"
    elif run_tests -R "$quick" && run_tests -L '^(unit|golden)$' -E "$quick" &&
      { [ ${#last[@]} -eq ${#targets[@]} ] || run_tests -L '^parity$'; }; then
      verdict=SURVIVES
    else
      verdict="noticed by $(sed -n 's/.*Test *#[0-9]*: \([^ ]*\) .*\(Failed\|Timeout\|Exception\).*/\1/p' "$here/test.log" | head -1)"
    fi
    [ "$verdict" = "does not compile" ] || mine=$((mine + 1))
    printf '%s\t%s\t%s\n' "$draw" "$verdict" "$change" | tee -a build-mutate/changes.txt
    git show "HEAD:$file" >"$tree/$file"
    draw=$((draw + workers))
  done
}

if [ "${OTG_MUTATE_WORKER:-}" ]; then
  cp -a "$here" "build-mutate/worker-$OTG_MUTATE_WORKER"
  mount --bind "build-mutate/worker-$OTG_MUTATE_WORKER" "$here"
  work "$OTG_MUTATE_WORKER"
  exit
fi

rm -rf build-mutate
mkdir -p "$tree"
git archive HEAD | tar -x -C "$tree"
cmake -S "$tree" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DOTG_BUILD_BENCHMARKS=OFF -DOTG_BUILD_DEMOS=OFF >/dev/null
cmake --build "$build" --target "${targets[@]}" -- -j"$workers" >build-mutate/build.log
if ! run_tests -j"$workers" -L '^(unit|golden)$' --output-junit "$here/times.xml"; then
  echo "tests fail without a change: see build-mutate/here/test.log" >&2
  exit 1
fi
# A regular expression of the tests that take less than two seconds.
quick=^\($(sed -n 's/.*<testcase name="\([^"]*\)".* time="[01]\.[^"]*".*/\1/p' "$here/times.xml" | paste -sd'|')\)\$
export quick
pids=()
for worker in $(seq 0 $((workers - 1))); do
  OTG_MUTATE_WORKER=$worker unshare --user --map-root-user --mount bash scripts/mutate.sh "$count" "$seed" "$pattern" &
  pids+=($!)
done
for pid in "${pids[@]}"; do
  wait "$pid" || { echo "a worker ended before its changes were done" >&2; exit 1; }
done
echo "$(grep -cv 'does not compile' build-mutate/changes.txt) changes, $(grep -c SURVIVES build-mutate/changes.txt) survivors"
