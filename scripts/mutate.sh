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
# A run that was ended goes on at the next call, if the commit is the same: it keeps what was built, and passes over the
# changes that are listed in build-mutate/changes.txt.
#
# A change that does not compile, or that changes nothing (a bound that no value meets), tells nothing: look at each
# survivor. Each takes a build and, unless a test fails at once, all unit and golden tests, the quick ones first; changes of
# kernels and of what talks to devices take the parity tests, too. How long tests take is what ctest wrote down in build/
# (scripts/test.sh); tests without a time come last. Number 0 is no change: all tests have to pass there.
#
# Each core sees its copy at the same path, by a mount of its own (unshare), so that nothing is built twice. By mounts, too,
# tests see a machine with one core: all threads of many cores on one would wait for each other. Kernels run on PoCL,
# because a broken one may stop a GPU; but on a GPU where the loader of OpenCL does not heed OCL_ICD_VENDORS.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

count=${1:-200}
seed=${2:-1}
pattern=${3:-}
workers=$(nproc)
work=$PWD/build-mutate
here=$work/here
tree=$here/tree
build=$here/build
targets=(tests_unit tests_golden)
mkdir -p "$work/vendors"
cp /etc/OpenCL/vendors/pocl.icd "$work/vendors/"
export OCL_ICD_VENDORS=$work/vendors

# needs_device FILE: whether tests with devices may notice a change of it.
needs_device() {
  case "$1" in
    kernels/* | ode_trimesh_gpu/opencl/* | ode_trimesh_gpu/dispatch/*) ;;
    ode_trimesh_gpu/ode/library/backend_api.cpp | ode_trimesh_gpu/collide/solid/found_overlap.cpp) ;;
    *) return 1 ;;
  esac
}

# list_groups LABELS: the tests with these labels in groups, the quick ones first: a limit of time in seconds, and a regular
# expression of names.
list_groups() {
  ctest --test-dir "$build" -N -L "$1" | sed -n 's/^ *Test *#[0-9]*: //p' | awk '
    FILENAME != "-" { if (NF == 3) seconds[$1] = $3; next }
    { cost = $1 in seconds ? seconds[$1] : 1e9
      for (group = 0; group < 4 && cost > 0.5 * 4 ^ group; group++) {}
      names[group] = names[group] "|" $1 }
    END { for (group = 0; group < 5; group++) if (group in names)
            print group < 4 ? 30 + 5 * 4 ^ group : 1200, "^(" substr(names[group], 2) ")$" }' "$work/costs" -
}

# run_groups FILE: whether all tests of its groups pass; stops at the first that fails. One that is skipped fails, and a group
# that takes longer than the limits of its tests. (Each test has a longer limit of its own, which `ctest --timeout` leaves.)
run_groups() {
  local limit names separators
  while read -r limit names; do
    separators=${names//[!|]/}
    timeout $((limit * (${#separators} + 1))) ctest --test-dir "$build" --no-tests=error --stop-on-failure -R "$names" \
      >"$here/test.log" 2>&1 </dev/null || return 1
    ! grep -q '\*\*\*Skipped' "$here/test.log" || return 1
  done <"$1"
}

# run_tests FILE: whether all tests pass that may notice a change of it.
run_tests() {
  case "$1" in
    kernels/*) run_groups "$work/parity.groups" && run_groups "$work/host.groups" ;;
    *) run_groups "$work/host.groups" && { ! needs_device "$1" || run_groups "$work/parity.groups"; } ;;
  esac
}

restore() {
  [ ! -s "$here/broken" ] || git show "HEAD:$(cat "$here/broken")" >"$tree/$(cat "$here/broken")"
  : >"$here/broken"
}

# mount_copy NUMBER: what was built, with the changes of one core, at `here`; and a machine of one core.
mount_copy() {
  local own=$work/worker-$1
  mkdir -p "$own/upper" "$own/work"
  if ! mount -t overlay overlay -o "lowerdir=$here,upperdir=$own/upper,workdir=$own/work" "$here" 2>/dev/null; then
    [ -d "$own/copy" ] || { cp -a "$here" "$own/part" && mv "$own/part" "$own/copy"; }
    mount --bind "$own/copy" "$here"
  fi
  echo 0 >"$work/online"
  mount --bind "$work/online" /sys/devices/system/cpu/online
}

# next_change: takes the first line off the queue.
next_change() {
  (
    flock 9
    head -1 "$work/queue"
    sed -i 1d "$work/queue"
  ) 9>"$work/lock"
}

# take_changes: breaks, builds and tests, until the queue that all cores share is empty.
take_changes() {
  local draw file change verdict taken last
  restore
  while taken=$(next_change) && [ "$taken" ]; do
    read -r draw file <<<"$taken"
    SECONDS=0
    change=$'none\t\t'
    if [ "$draw" != 0 ]; then
      echo "$file" >"$here/broken"
      change=$(python3 scripts/mutate.py "$tree" "$draw" "$pattern")
    fi
    last=("${targets[@]}")
    ! needs_device "$file" || last+=(tests_parity)
    if ! cmake --build "$build" --target "${last[@]}" -- -j1 >"$here/build.log" 2>&1; then
      verdict="does not compile"
    elif run_tests "$file"; then
      verdict=SURVIVES
    else
      verdict="noticed by $(sed -n 's/.*Test *#[0-9]*: \([^ ]*\) .*\(Failed\|Timeout\|Exception\|Skipped\).*/\1/p' "$here/test.log" | head -1)"
    fi
    printf '%s\t%s\t%s\t%s s\n' "$draw" "$verdict" "$change" "$SECONDS" | tee -a "$work/changes.txt"
    restore
  done
}

if [ "${OTG_MUTATE_WORKER:-}" ]; then
  mount_copy "$OTG_MUTATE_WORKER"
  if [ "$OTG_MUTATE_WORKER" = all ]; then
    ctest --test-dir "$build" --no-tests=error --timeout 600 -j"$workers" -L '^(unit|golden)$' >"$work/test.log" 2>&1
  else
    taskset -cp "$OTG_MUTATE_WORKER" $$ >/dev/null
    take_changes
  fi
  exit
fi

# start WORKER: this script in mounts of its own.
start() {
  OTG_MUTATE_WORKER=$1 unshare --user --map-root-user --mount bash scripts/mutate.sh "$count" "$seed" "$pattern"
}

commit=$(git rev-parse HEAD)
if [ "$(cat "$work/commit" 2>/dev/null)" != "$commit" ]; then
  rm -rf "$work"/{ready,here,worker-*,changes.txt}
  mkdir -p "$tree"
  git archive HEAD | tar -x -C "$tree"
  echo "$commit" >"$work/commit"
fi
if [ ! -e "$work/ready" ]; then
  cmake -S "$tree" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DOTG_BUILD_BENCHMARKS=OFF -DOTG_BUILD_DEMOS=OFF \
    -DCMAKE_UNITY_BUILD=OFF >/dev/null
  cmake --build "$build" --target "${targets[@]}" tests_parity -- -j"$workers" >"$work/build.log"
  rm -rf "$work/worker-all"
  start all || { echo "tests fail without a change: see $work/test.log" >&2; exit 1; }
  cat "$work"/worker-all/*/build/Testing/Temporary/CTestCostData.txt build/Testing/Temporary/CTestCostData.txt \
    >"$work/costs" 2>/dev/null || true
  list_groups '^(unit|golden)$' >"$work/host.groups"
  list_groups '^parity$' >"$work/parity.groups"
  touch "$work/ready"
fi

# The queue: no change, then one of the host's for each core while the first fills the cache of kernels, then what takes
# longest.
touch "$work/changes.txt"
{
  echo 0 kernels/
  python3 scripts/mutate.py "$tree" "$seed" "$pattern" "$count"
} | awk 'FILENAME != "-" { listed[$1] = 1; next } !($1 in listed)' "$work/changes.txt" - >"$work/drawn"
while read -r draw file; do
  rank=1
  ! needs_device "$file" || rank=2
  [ "$draw" != 0 ] || rank=0
  echo "$rank $draw $file"
done <"$work/drawn" | awk -v cores="$workers" '$1 == 1 && ++host > cores { $1 = 3 } 1' | sort -n | cut -d' ' -f2- >"$work/queue"

pids=()
for worker in $(seq 0 $((workers - 1))); do
  start "$worker" &
  pids+=($!)
done
for pid in "${pids[@]}"; do
  wait "$pid" || { echo "a worker ended before its changes were done" >&2; exit 1; }
done
grep -q $'^0\tSURVIVES' "$work/changes.txt" || { echo "tests fail without a change" >&2; exit 1; }
echo "$(grep -vc $'^0\t\|does not compile' "$work/changes.txt") changes, $(grep -c $'^[1-9].*\tSURVIVES' "$work/changes.txt") survivors"
