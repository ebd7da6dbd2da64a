#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs the libFuzzer targets of tests/fuzz under AddressSanitizer and UndefinedBehaviorSanitizer (folder build-asan/), as many at
# once as there are cores. Each begins with generated seeds and with what earlier runs found new (build-asan/corpus/).
#
#   scripts/fuzz.sh                  a minute for each target; continuous integration takes 10 seconds
#   scripts/fuzz.sh 600              ten minutes for each, as before a release
#   scripts/fuzz.sh 60 cooked api    only these: ply off obj stl cooked scene poses api
#
# Exit status 0 if nothing was found. What breaks a target stays in build-asan/found/. Installs what is missing first: see
# install_dependencies.sh.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

seconds=${1:-60}
[ $# -eq 0 ] || shift
targets=("$@")
[ ${#targets[@]} -gt 0 ] || targets=(ply off obj stl cooked scene poses api)

bash scripts/install_dependencies.sh tests
cmake --preset asan -DOTG_FUZZ_SECONDS="$seconds" >/dev/null
cmake --build --preset asan --target "${targets[@]/#/fuzz_}" "${targets[@]/#/replay_}" -- -j"$(nproc)"
names=$(IFS='|'; echo "${targets[*]}")
ctest --preset asan -j"$(nproc)" --no-tests=error -R "^fuzz\\.($names)\$" -V
