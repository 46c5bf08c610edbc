#!/usr/bin/env bash
# debian_sources.sh [--suite SUITE] PACKAGE ...: fetches and unpacks source packages of Debian 12, or of another suite, without
# Debian's patches, and prints the folder that has one folder for each. Exit status 77 where they cannot be had.
set -euo pipefail
cd "$(dirname "$0")/.."

suite=bookworm
if [ "$1" = --suite ]; then
  suite=$2
  shift 2
fi
folder=$PWD/build/debian-sources/$suite
mkdir -p "$folder"
if ! command -v dpkg-source >/dev/null; then
  echo "debian_sources: no dpkg-source (dpkg-dev) here" >&2
  exit 77
fi
for package in "$@"; do
  [ -d "$folder/$package" ] && continue
  if ! (cd "$folder" && "$OLDPWD/scripts/debian_apt.sh" "$suite" source --download-only "$package" >/dev/null); then
    echo "debian_sources: no source package $package of $suite" >&2
    exit 77
  fi
  description=$(find "$folder" -name "${package}_*.dsc" | head -n 1)
  dpkg-source --no-check --skip-patches -x "$description" "$folder/$package" >/dev/null 2>&1
done
echo "$folder"
