#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs the libFuzzer targets of tests/fuzz under AddressSanitizer and UndefinedBehaviorSanitizer (folder build-fuzz/). Each begins
# with generated seeds and with what earlier runs found new (build-fuzz/corpus/). Needs Clang (Debian: clang).
#
#   scripts/fuzz.sh                  a minute for each target
#   scripts/fuzz.sh 600              ten minutes for each, as before a release
#   scripts/fuzz.sh 60 cooked api    only these: ply off obj stl cooked scene poses api
#
# Exit status 0 if nothing was found. What breaks a target stays in build-fuzz/found/.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

seconds=${1:-60}
[ $# -eq 0 ] || shift
targets=("$@")
[ ${#targets[@]} -gt 0 ] || targets=(ply off obj stl cooked scene poses api)
if ! command -v clang++ >/dev/null; then
  echo "clang++ is not installed (Debian: clang)" >&2
  exit 1
fi

cmake --preset fuzz >/dev/null
programs=()
for target in "${targets[@]}"; do programs+=("fuzz_$target" "replay_$target"); done
cmake --build build-fuzz --target "${programs[@]}" -- -j"$(nproc)"

export ASAN_OPTIONS=detect_leaks=0:allocator_may_return_null=1 UBSAN_OPTIONS=print_stacktrace=1
mkdir -p build-fuzz/found
status=0
for target in "${targets[@]}"; do
  corpus=build-fuzz/corpus/$target
  mkdir -p "$corpus"
  "build-fuzz/bin/replay_$target" "$corpus"
  echo "== $target: $seconds seconds"
  "build-fuzz/bin/fuzz_$target" -max_total_time="$seconds" -timeout=30 -rss_limit_mb=4096 -print_final_stats=1 -verbosity=0 \
    -artifact_prefix="build-fuzz/found/${target}_" "$corpus" || status=1
done
exit $status
