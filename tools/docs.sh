#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds the site into build/docs/html (or FOLDER/html): pages by Sphinx, the C++ API by Doxygen. A warning is an error.
# Usage: tools/docs.sh [FOLDER]
set -euo pipefail
cd "$(dirname "$0")/.."
out=$(realpath -m "${1:-build/docs}")

rm -rf "$out"
mkdir -p "$out/source/project" "$out/source/cpp_html"
cp -r docs/. "$out/source"
cp ARCHITECTURE.md CHANGELOG.md CONTRIBUTING.md NOTATION.md "$out/source/project"

{ cat docs/Doxyfile; echo "OUTPUT_DIRECTORY = $out/source/cpp_html"; } | doxygen -
# Debian's own Python: another one in PATH may lack Sphinx.
/usr/bin/python3 -m sphinx -q -W --keep-going -b html "$out/source" "$out/html"
echo "$out/html/index.html"
