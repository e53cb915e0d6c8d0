#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# From nothing to a force: installs, builds, estimates the force of a virtual recording and compares it with the truth; then
# runs the live instrument before a beating heart, whose page opens in a browser. Without a display it prints the forces.
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
echo

live=(build/release/bin/palpate serve --demo --openigtlink-port 0 --dashboard-port 0)
if [[ -n ${DISPLAY:-}${WAYLAND_DISPLAY:-} ]]; then
  echo "Live: open the dashboard's address in a browser."
else
  live+=(--print)
fi
# Nobody is there to end it: ten seconds are enough to see.
[[ -t 1 ]] || live+=(--for 10)
"${live[@]}"
[[ -t 1 ]] || echo "Again, for as long as you like: $PWD/build/release/bin/palpate serve --demo prints the dashboard's address"
