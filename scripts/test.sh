#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds everything and runs every test. The last line of output reads "N passed, N failed", with ", N skipped" if any were.
#
#   scripts/test.sh                  all tests, optimised build (folder build/)
#   scripts/test.sh --sanitize       also the unit and parity tests under AddressSanitizer + UndefinedBehavior-
#                                    Sanitizer (build-asan/) and under ThreadSanitizer (build-tsan/)
#   scripts/test.sh --sanitize=asan  only one of the two; =tsan likewise
#   scripts/test.sh --sanitize=core  both, but only of the few tests that reach most of the library, and 10 seconds
#                                    of each fuzz target
#   scripts/test.sh -R collide       further words are handed to ctest
#
# Exit status 0 if everything passed. Installs what is missing first: see install_dependencies.sh.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

sanitizers=()
core=
ctest_words=()
for word in "$@"; do
  case "$word" in
    --sanitize) sanitizers=(asan tsan) ;;
    --sanitize=core) sanitizers=(asan tsan) core=yes ;;
    --sanitize=asan | --sanitize=tsan) sanitizers=("${word#--sanitize=}") ;;
    -h | --help) sed -n '3,/^set/{/^set/d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;;
    *) ctest_words+=("$word") ;;
  esac
done

bash scripts/install_dependencies.sh tests

# Real meshes for the oracle; without them its test of real meshes is left out.
meshes=$(bash scripts/cgal_meshes.sh build/meshes) || meshes=
# The Python package is tested where its tools can be had: they come from PyPI.
python=$(bash scripts/python.sh --tools) || { python= && echo "$0: no tools for Python: its tests are left out" >&2; }
jobs=$(nproc)
passed=0
failed=0
skipped=0
status=0

# run_preset PRESET TARGETS [ctest words]: configures, builds TARGETS, runs ctest and adds to the counts above.
run_preset() {
  local preset=$1 targets=$2 folder=build module= report counts
  shift 2
  [ "$preset" != default ] || module=$python
  [ "$preset" = default ] || folder=build-$preset
  echo "== $preset: configure and build"
  # Without these two packages a build would leave out the tests. Here that is an error.
  cmake --preset "$preset" -DCMAKE_REQUIRE_FIND_PACKAGE_Catch2=ON -DCMAKE_REQUIRE_FIND_PACKAGE_Python3=ON \
    ${core:+-DOTG_FUZZ_SECONDS=10} ${meshes:+-DOTG_CGAL_DEMO_DATA="$meshes"} ${module:+-DOTG_BUILD_PYTHON=ON -DPython_EXECUTABLE="$module"}
  # shellcheck disable=SC2086  # several targets
  cmake --build --preset "$preset" --target $targets -- -j"$jobs"
  echo "== $preset: test"
  report=$PWD/$folder/ctest_report.xml
  rm -f "$report"
  ctest --preset "$preset" -j"$jobs" --no-tests=error --output-junit "$report" "$@" || status=1
  if [ ! -f "$report" ]; then
    status=1
    return
  fi
  # ctest's JUnit report has one <testcase ... status="run|fail|notrun|disabled"> per test. A test that asked to be
  # skipped (exit status 77) and one whose program is missing are both "notrun"; only the first is a skip.
  counts=$(awk '
    /<testcase /              { open = 1; state = $0; sub(/.* status="/, "", state); sub(/".*/, "", state); skip = 0 }
    /<skipped message="SKIP_/ { if (open) skip = 1 }
    /<\/testcase>/       { open = 0; if (state == "run") passed++; else if (skip || state == "disabled") skipped++; else failed++ }
    END                       { print passed + 0, failed + 0, skipped + 0 }' "$report")
  read -r p f s <<<"$counts"
  passed=$((passed + p))
  failed=$((failed + f))
  skipped=$((skipped + s))
}

run_preset default all "${ctest_words[@]}"
for preset in "${sanitizers[@]}"; do
  if [ -n "$core" ]; then
    run_preset "$preset" "tests_core_$preset" -L "^core_$preset\$" "${ctest_words[@]}"
  else
    run_preset "$preset" "tests_unit tests_parity" -L '^(unit|parity)$' "${ctest_words[@]}"
  fi
done

[ "$failed" -eq 0 ] || status=1
summary="$passed passed, $failed failed"
[ "$skipped" -eq 0 ] || summary="$summary, $skipped skipped"
echo "$summary"
exit $status
