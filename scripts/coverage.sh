#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Which lines of the library the tests run (folder build-coverage/). Prints a table of files and writes
# build-coverage/coverage/index.html, where lines and branches without a test stand out. Needs gcovr (Debian: gcovr).
#
#   scripts/coverage.sh                   the unit, golden, parity and simulator tests
#   scripts/coverage.sh -L unit           further words are handed to ctest in place of these labels
#
# Kernels count where the host runs their headers, and in the simulated device. Asserts are on, as in a debug build.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

if ! command -v gcovr >/dev/null; then
  echo "gcovr is not installed (Debian: gcovr)" >&2
  exit 1
fi
words=("$@")
[ ${#words[@]} -gt 0 ] || words=(-L '^(unit|golden|parity|simulator)$')

cmake --preset coverage >/dev/null
cmake --build build-coverage -- -j"$(nproc)"
find build-coverage -name '*.gcda' -delete
status=0
ctest --test-dir build-coverage -j"$(nproc)" --output-on-failure "${words[@]}" || status=1
mkdir -p build-coverage/coverage
gcovr --root . --object-directory build-coverage --filter 'ode_trimesh_gpu/' --filter 'kernels/' \
  --exclude-throw-branches --exclude-unreachable-branches --gcov-ignore-parse-errors -j "$(nproc)" \
  --html-details build-coverage/coverage/index.html --txt build-coverage/coverage/coverage.txt
cat build-coverage/coverage/coverage.txt
exit $status
