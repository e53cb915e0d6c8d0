#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs what is missing of packages.txt. Says nothing when nothing is missing.
set -euo pipefail
cd "$(dirname "$0")/.."

if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
  echo "tools/install_packages.sh installs Debian packages, and this is not Debian." >&2
  echo "Install the equivalents of packages.txt by hand, then configure with CMake as CONTRIBUTING.md says." >&2
  exit 1
fi

# Names of what is installed and of what that provides: npm, say, may be a part of nodejs from elsewhere.
present=$(dpkg-query -W -f='${db:Status-Status}\t${Package}, ${Provides}\n' | sed -n 's/^installed\t//p' |
  tr ',' '\n' | sed 's/(.*//; s/ //g' | sort -u)

missing=()
while read -r package; do
  grep -qxF -- "$package" <<<"$present" || missing+=("$package")
done < <(sed 's/#.*//' packages.txt | tr -s ' \t' '\n' | grep .)
((${#missing[@]})) || exit 0

as_root=()
if ((EUID != 0)); then
  if ! command -v sudo >/dev/null; then
    echo "Missing: ${missing[*]}. Install them as root, or install sudo." >&2
    exit 1
  fi
  as_root=(sudo)
fi
echo "Installing ${missing[*]}"
"${as_root[@]}" apt-get -qq update
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -y --no-install-recommends install "${missing[@]}" \
  </dev/null >/dev/null
