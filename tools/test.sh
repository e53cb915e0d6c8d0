#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs, builds and tests. Usage: tools/test.sh [ci|asan]. The output of ctest stays in build/<preset>/ctest.log.
set -euo pipefail
cd "$(dirname "$0")/.."
preset=${1:-ci}

tools/install_packages.sh
cmake --preset "$preset"
cmake --build --preset "$preset"
ctest --preset "$preset" -j2 --no-tests=error 2>&1 | tee "build/$preset/ctest.log"
