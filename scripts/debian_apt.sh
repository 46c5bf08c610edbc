#!/usr/bin/env bash
# debian_apt.sh SUITE ARGUMENT...: apt-get ARGUMENT... with the packages and sources of that suite of Debian alone, whatever the
# system's own is, from the mirror of Debian that the system uses; its lists lie in build/debian/SUITE. DEBIAN_MIRROR: another
# mirror, for systems that are not Debian. Exit status 77 where they cannot be had.
set -euo pipefail

folder=$(cd "$(dirname "$0")/.." && pwd)/build/debian/$1
suite=$1
shift
keys=/usr/share/keyrings/debian-archive-keyring.gpg
if ! command -v apt-get >/dev/null || [ ! -e "$keys" ]; then
  echo "debian_apt: no apt-get or no keys of Debian (debian-archive-keyring) here" >&2
  exit 77
fi
options=(-q -o "Dir::Etc::sourcelist=$folder/sources.list" -o Dir::Etc::sourceparts=- -o "Dir::State=$folder"
  -o "Dir::Cache=$folder" -o Dir::State::status=/dev/null -o APT::Sandbox::User=)
if [ ! -e "$folder/complete" ]; then
  mirror=${DEBIAN_MIRROR:-$(apt-get indextargets --format '$(ORIGIN) $(REPO_URI)' | sed -n 's|^Debian \(.*/debian/\)$|\1|p' | head -n 1)}
  if [ -z "$mirror" ]; then
    echo "debian_apt: this system knows no mirror of Debian; name one in DEBIAN_MIRROR, or run apt-get update" >&2
    exit 77
  fi
  mkdir -p "$folder/lists/partial" "$folder/archives/partial"
  printf "%s [signed-by=$keys] $mirror $suite main\n" deb deb-src >"$folder/sources.list"
  if ! apt-get "${options[@]}" -o APT::Update::Error-Mode=any update >"$folder/log" 2>&1; then
    echo "debian_apt: the lists of $suite cannot be had: see $folder/log" >&2
    exit 77
  fi
  touch "$folder/complete"
fi
exec apt-get "${options[@]}" "$@"
