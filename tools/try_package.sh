#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs the Debian packages of a build in a bare Debian 12 root and uses them there: estimates an example's force,
# reads the manual, completes in the shells, draws the force in Python, builds the consumer project. To be run as root; fetches some 500 MB from
# the mirror that apt is configured with.
# Usage: tools/try_package.sh [ROOT] [BUILD]     ROOT: kept, and used again; a temporary one is removed
set -euo pipefail
cd "$(dirname "$0")/.."
root=${1:-}
build=$(realpath "${2:-build/release}")
[[ $EUID == 0 ]] || { echo "tools/try_package.sh: expected to be run as root: debootstrap and chroot want it" >&2; exit 2; }
for program in debootstrap cpack; do
  command -v "$program" >/dev/null || { echo "tools/try_package.sh: expected $program to be installed" >&2; exit 2; }
done
[[ -f $build/CPackConfig.cmake ]] || { echo "tools/try_package.sh: $build: expected a build" >&2; exit 2; }

packages=$(mktemp -d)
bare=
cleanup() {
  rm -rf "$packages"
  [[ -z $bare ]] || umount "$bare/proc" 2>/dev/null || true
  [[ -n $root || -z $bare ]] || rm -rf --one-file-system "$bare"
}
trap cleanup EXIT

mirror=$(apt-get indextargets --format '$(SITE) $(CODENAME) $(COMPONENT)' 'Created-By: Packages' |
  awk '$2 == "bookworm" && $3 == "main" { print $1; exit }')
[[ -n $mirror ]] || { echo "tools/try_package.sh: expected a source of bookworm main in apt's configuration" >&2; exit 2; }

cpack -G DEB --config "$build/CPackConfig.cmake" -B "$packages" >/dev/null
bare=${root:-$(mktemp -d)}
if [[ ! -e $bare/etc/debian_version ]]; then
  echo "== a bare root"
  debootstrap --variant=minbase bookworm "$bare" "$mirror" >"$packages/log" || { tail "$packages/log" >&2; exit 1; }
fi
mkdir -p "$bare/packages"
rm -f "$bare"/packages/*.deb
cp "$packages"/*.deb "$bare/packages"
for file in /etc/apt/apt.conf /etc/apt/apt.conf.d/*proxy*; do # how apt reaches the mirror
  [[ -f $file ]] && install -D -m 644 "$file" "$bare$file"
done
mountpoint -q "$bare/proc" || mount -t proc proc "$bare/proc"

inside() { chroot "$bare" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 \
  DEBIAN_FRONTEND=noninteractive bash -euo pipefail -c "$1"; }
install_packages() { inside "apt-get -qq update && apt-get -qq -y install $1 >/var/log/try_package 2>&1 ||
  { tail -n 20 /var/log/try_package >&2; exit 1; }"; }

echo "== the program, with nothing but what its package asks for"
install_packages "--no-install-recommends /packages/palpate_*.deb"
inside 'palpate --version
  cd /root
  palpate simulate /usr/share/doc/palpate/examples/scenarios/beating_heart.toml --out run --duration 10 >/dev/null
  palpate estimate --catheter run.catheter.toml run.tracker.csv --out run.estimate.csv
  palpate evaluate --estimate run.estimate.csv --truth run.force.csv'

echo "== manual and completion"
install_packages "--no-install-recommends man-db bash-completion zsh fish"
inside 'man -P cat palpate-estimate >/root/page; head -n 12 /root/page
  fish -c "complete -C \"palpate estimate --method ie\"" | grep iekf
  fish -c "complete -C \"palpate identify \"" | grep noise
  zsh -n /usr/share/zsh/vendor-completions/_palpate
  echo "zsh reads its script"
  cat >/root/ask.bash <<"ASK"
source /usr/share/bash-completion/completions/palpate
COMP_WORDS=(palpate study report --pictures "")
COMP_CWORD=4
_palpate
echo "bash proposes ${COMPREPLY[*]}"
ASK
  bash /root/ask.bash | grep "svg png"'

echo "== Python"
install_packages "--no-install-recommends /packages/python3-palpate_*.deb"
inside 'cd /root
  python3 -c "import palpate; print(palpate.__version__, palpate.__file__)"
  python3 /usr/share/doc/python3-palpate/examples/05_batch.py'
install_packages "python3-matplotlib"
inside 'cd /root
  python3 /usr/share/doc/python3-palpate/python/examples/force_plot.py run.catheter.toml run.tracker.csv run.force.csv'

echo "== the library, and a project that uses it"
install_packages "/packages/libpalpate-dev_*.deb cmake make g++"
inside 'cd /root
  cmake -S /usr/share/doc/libpalpate-dev/examples/consumer -B consumer >/dev/null
  cmake --build consumer | tail -n 1
  consumer/feel_force
  consumer/many_rods
  consumer/find_precurvature'
echo "== all of it worked"
