#!/usr/bin/env bash
# setup.sh [LIST]: installs the packages of scripts/packages.txt, or of another list, that are missing. Does nothing, and
# needs no rights, when all are there.
# OCCLOD_SKIP_SETUP=1 skips it, for systems whose dependencies come from elsewhere.
set -euo pipefail
cd "$(dirname "$0")/.."

[ "${OCCLOD_SKIP_SETUP:-0}" = 1 ] && exit 0

list=${1:-scripts/packages.txt}
packages() { sed -e 's/#.*//' -e '/^[[:space:]]*$/d' "$list"; }

if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
  {
    echo "setup: no apt on this system. Install what these Debian packages hold, then run again with OCCLOD_SKIP_SETUP=1:"
    packages | sed 's/^/  /'
  } >&2
  exit 1
fi

is_installed() { [ "$(dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null)" = installed ]; }

missing=()
missing_optional=()
while read -r name mark; do
  is_installed "$name" && continue
  if [ "${mark:-}" = optional ]; then missing_optional+=("$name"); else missing+=("$name"); fi
done < <(packages)

[ ${#missing[@]} -eq 0 ] && [ ${#missing_optional[@]} -eq 0 ] && exit 0

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  if ! command -v sudo >/dev/null; then
    [ ${#missing[@]} -eq 0 ] && exit 0
    echo "setup: run as root: apt-get install ${missing[*]}" >&2
    exit 1
  fi
  as_root=(sudo)
fi

install_packages() {
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends "$@" </dev/null >&2
}

"${as_root[@]}" apt-get update </dev/null >&2 || echo "setup: apt-get update failed; trying with the lists that are there" >&2
[ ${#missing[@]} -eq 0 ] || install_packages "${missing[@]}"
for name in "${missing_optional[@]}"; do
  install_packages "$name" || echo "setup: $name is not to be had here; going on without it" >&2
done
