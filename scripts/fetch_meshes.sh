#!/usr/bin/env bash
# fetch_meshes.sh [armadillo] [dragon] [buddha] [lucy]: gets models of the Stanford 3D Scanning Repository into the user's mesh folder;
# without arguments the first three (Lucy is 1 GB unpacked). Their terms: https://graphics.stanford.edu/data/3Dscanrep/
# The numbers of vertices and triangles in each header are compared with those that Stanford publishes. No SHA-256 of the
# originals is recorded yet: the sum is printed, not checked.
set -euo pipefail

folder=${XDG_DATA_HOME:-$HOME/.local/share}/occlod/meshes
site=https://graphics.stanford.edu
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

header_count() { LC_ALL=C head -c 4096 "$1" | LC_ALL=C grep -a -m 1 "^element $2 " | tr -d '\r' | cut -d ' ' -f 3; }

# get TARGET URL MEMBER VERTICES TRIANGLES; MEMBER of the archive, or - for a mesh that is only compressed.
get() {
  local target=$folder/$1 url=$site/$2 member=$3 vertices=$4 triangles=$5
  if [ -s "$target" ]; then echo "$target is there"; return; fi
  curl --fail --location --output "$work/download" "$url"
  if [ "$member" = - ]; then gzip -dc "$work/download" >"$work/mesh"; else tar -xzOf "$work/download" "$member" >"$work/mesh"; fi
  local found
  found="$(header_count "$work/mesh" vertex) $(header_count "$work/mesh" face)"
  if [ "$found" != "$vertices $triangles" ]; then
    echo "fetch_meshes: $url holds $found vertices and triangles, not $vertices $triangles; it is not kept" >&2
    return 1
  fi
  echo "sha256 (not checked): $(sha256sum <"$work/mesh" | cut -d ' ' -f 1)  $1"
  mkdir -p "$folder"
  mv "$work/mesh" "$target"
}

[ $# -gt 0 ] || set -- armadillo dragon buddha
for name in "$@"; do
  case $name in
    armadillo) get Armadillo.ply pub/3Dscanrep/armadillo/Armadillo.ply.gz - 172974 345944 ;;
    dragon) get dragon_vrip.ply pub/3Dscanrep/dragon/dragon_recon.tar.gz dragon_recon/dragon_vrip.ply 437645 871414 ;;
    buddha) get happy_vrip.ply pub/3Dscanrep/happy/happy_recon.tar.gz happy_recon/happy_vrip.ply 543652 1087716 ;;
    lucy) get lucy.ply data/3Dscanrep/lucy.tar.gz lucy.ply 14027872 28055742 ;;
    *) echo "fetch_meshes: no model \"$name\"; use armadillo, dragon, buddha or lucy" >&2; exit 2 ;;
  esac
done
