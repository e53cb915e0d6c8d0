#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# From nothing to a picture: installs, builds, makes a virtual recording, estimates the force and compares it with the truth.
set -euo pipefail
cd "$(dirname "$0")/.."

tools/install_packages.sh
# The library, the command line and the demo only: no tests, no benchmarks.
cmake --preset release >/dev/null
cmake --build --preset release --target palpate_cli make_demo_recording

demo=build/demo
mkdir -p "$demo"
build/release/bin/make_demo_recording "$demo"
build/release/bin/palpate estimate --catheter "$demo/demo.catheter.toml" "$demo/demo.tracker.csv" \
  --out "$demo/demo.estimate.csv" --plot "$demo/demo.svg"
build/release/bin/palpate evaluate --estimate "$demo/demo.estimate.csv" --truth "$demo/demo.force.csv"
echo "The picture: $PWD/$demo/demo.svg"
