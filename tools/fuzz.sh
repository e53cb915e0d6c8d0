#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Feeds the OpenIGTLink codec with damaged messages (libFuzzer, address and undefined-behaviour sanitizers).
#   tools/fuzz.sh [SECONDS]      for so long; 60 by default
#   tools/fuzz.sh --runs N       N inputs
#   tools/fuzz.sh --corpus       writes the seeds in tests/fuzz/corpus/link again
# Ends with an error on a finding; the input is then in build/fuzz/findings.
set -eu
cd "$(dirname "$0")/.."
folder=build/fuzz
seeds=tests/fuzz/corpus/link
compiler=${CXX_FUZZ:-clang++}
codec="palpate/link/codec.cpp palpate/link/crc64.cpp palpate/link/decode.cpp palpate/link/encode.cpp palpate/link/header.cpp palpate/link/polydata.cpp"
mkdir -p "$folder/findings"

case "${1:-60}" in
  --corpus)
    $compiler -std=c++20 -O1 -I. -DFMT_HEADER_ONLY tests/fuzz/make_link_corpus.cpp $codec -o "$folder/make_link_corpus"
    exec "$folder/make_link_corpus" "$seeds"
    ;;
  --runs) limit=-runs=${2:?tools/fuzz.sh --runs N: expected a number} ;;
  *[!0-9]*) echo "tools/fuzz.sh: '$1': expected seconds, --runs N or --corpus" >&2; exit 2 ;;
  *) limit=-max_total_time=${1:-60} ;;
esac

$compiler -std=c++20 -O2 -g1 -I. -DFMT_HEADER_ONLY -fsanitize=fuzzer,address,undefined -fno-sanitize-recover=all \
  tests/fuzz/link_fuzz.cpp $codec -o "$folder/link_fuzz"
rm -rf "$folder/corpus"
cp -r "$seeds" "$folder/corpus"
exec "$folder/link_fuzz" "$limit" -timeout=25 -rss_limit_mb=512 -max_len=1024 -print_final_stats=1 \
  -artifact_prefix="$folder/findings/" "$folder/corpus"
