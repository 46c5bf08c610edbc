#!/usr/bin/env bash
# debian_sources.sh PACKAGE ...: fetches and unpacks Debian's source packages, without Debian's patches, and prints the folder
# that has one folder for each. Exit status 77 where they cannot be had: apt needs a deb-src line.
set -euo pipefail
cd "$(dirname "$0")/.."

folder=$PWD/build/debian-sources
mkdir -p "$folder"
if ! command -v apt-get >/dev/null || ! command -v dpkg-source >/dev/null; then
  echo "debian_sources: no apt-get or no dpkg-source (dpkg-dev) here" >&2
  exit 77
fi
for package in "$@"; do
  [ -d "$folder/$package" ] && continue
  if ! (cd "$folder" && apt-get source --download-only -y "$package" >/dev/null 2>&1); then
    echo "debian_sources: no source package $package: give apt a deb-src line, then run apt-get update" >&2
    exit 77
  fi
  description=$(find "$folder" -name "${package}_*.dsc" | head -n 1)
  dpkg-source --no-check --skip-patches -x "$description" "$folder/$package" >/dev/null 2>&1
done
echo "$folder"
