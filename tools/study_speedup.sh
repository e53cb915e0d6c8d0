#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Speed-up of a study on two cores: one worker pinned to one core against two workers pinned to two, in turn, so that
# both see the same machine. Prints every pair and the ratio of the medians. PAIRS=n, CPUS="0 1", STUDY=file.
set -euo pipefail
cd "$(dirname "$0")/.."
palpate=${1:-build/ci/bin/palpate}
study=${STUDY:-examples/studies/single_update.toml}
read -r first second <<<"${CPUS:-0 1}"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

seconds() { # CPUS WORKERS
  rm -f "$folder"/r.study
  local begin=$EPOCHREALTIME
  taskset -c "$1" "$palpate" study "$study" --out "$folder/r.study" --workers "$2" >/dev/null
  awk -v a="$begin" -v b="$EPOCHREALTIME" 'BEGIN { printf "%.3f", b - a }'
}
median() { sort -n | awk '{ t[NR] = $1 } END { print (t[int((NR + 1) / 2)] + t[int(NR / 2) + 1]) / 2 }'; }

for ((i = 1; i <= ${PAIRS:-7}; ++i)); do
  one=$(seconds "$first" 1)
  two=$(seconds "$first,$second" 2)
  echo "$one" >>"$folder/one"
  echo "$two" >>"$folder/two"
  echo "one core $one s, two cores $two s, load $(cut -d' ' -f1 /proc/loadavg)"
done
awk -v a="$(median <"$folder/one")" -v b="$(median <"$folder/two")" \
  'BEGIN { printf "medians %.2f s and %.2f s: speed-up %.3f\n", a, b, a / b }'
