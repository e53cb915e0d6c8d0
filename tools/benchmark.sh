#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds the benchmarks, runs them and prints the ratios that the documents claim; JSON stays in
# build/<preset>/benchmark_results/.
# Usage: tools/benchmark.sh [preset] [all]      "all": every filter in every layout as well, some ten minutes more
set -euo pipefail
cd "$(dirname "$0")/.."
preset=${1:-release}
build=build/$preset
out=$build/benchmark_results
claims='^(rod|textbook|bare_update)/'
rows="$claims|^update/iekf/(poses|tip_and_curvature)/(random_walk|constant_velocity)\$"
[[ ${2:-} == all ]] && rows=.

cmake --preset "$preset" >/dev/null
cmake --build --preset "$preset" \
  --target benchmark_force_observer benchmark_batch benchmark_latency benchmark_accuracy
rm -rf "$out"
mkdir -p "$out"

# Rows in turn, so that what else the machine does falls on all of them alike.
rows_to() {
  "$build/bin/benchmark_force_observer" --benchmark_filter="$2" --benchmark_repetitions="$3" \
    --benchmark_min_time=0.05 --benchmark_enable_random_interleaving=true --benchmark_out="$1" \
    --benchmark_out_format=json >/dev/null 2>"$out/stderr"
}
rows_to "$out/rows.json" "$rows" 9 || { cat "$out/stderr" >&2; exit 1; }
for set in baseline avx2 avx512; do # each against the yardstick in its own run
  PALPATE_INSTRUCTION_SET=$set rows_to "$out/rows.$set.json" "$claims" 5 || rm -f "$out/rows.$set.json"
done
"$build/bin/benchmark_batch" --benchmark_out="$out/batch.json" --benchmark_out_format=json >/dev/null
"$build/bin/benchmark_accuracy" --json >"$out/accuracy.json"
status=0
"$build/bin/benchmark_latency" --json >"$out/latency.json" || status=$?
python3 tools/benchmark_ratios.py "$out"
exit $status
