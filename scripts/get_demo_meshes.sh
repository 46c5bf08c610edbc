#!/usr/bin/env bash
# Puts meshes of the Debian package libcgal-demo into the user's mesh folder, where scenes look for them. The package need not be
# installed, and where it is, its documentation may have been left out, as container images do: then it is downloaded and unpacked only.
set -euo pipefail

folder=${XDG_DATA_HOME:-$HOME/.local/share}/occlod/meshes
names=(armadillo.off bunny00.off elephant.off)

missing=()
for name in "${names[@]}"; do [ -s "$folder/$name" ] || missing+=("$name"); done
[ ${#missing[@]} -eq 0 ] && exit 0

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Takes what is missing out of one archive; returns 0 when nothing is missing any more.
take_from() {
  local archive=$1 name member still=()
  for name in "${missing[@]}"; do
    member=$(tar -tzf "$archive" | grep -m 1 "/$name\$" || true)
    if [ -n "$member" ] && tar -xzOf "$archive" "$member" >"$work/$name"; then
      mkdir -p "$folder"
      mv "$work/$name" "$folder/$name"
    else
      still+=("$name")
    fi
  done
  missing=("${still[@]}")
  [ ${#missing[@]} -eq 0 ]
}

take_from_folder() {
  local archive
  for archive in "$1"/usr/share/doc/libcgal-*/{data,demo,examples}.tar.gz; do
    if [ -f "$archive" ] && take_from "$archive"; then return 0; fi
  done
  return 1
}

take_from_folder "" && exit 0
if command -v apt-get >/dev/null && command -v dpkg-deb >/dev/null && (cd "$work" && apt-get download libcgal-demo >&2); then
  mkdir "$work/package"
  dpkg-deb --fsys-tarfile "$work"/libcgal-demo_*.deb | tar -xf - -C "$work/package" --wildcards './usr/share/doc/*.tar.gz'
  take_from_folder "$work/package" && exit 0
fi
echo "get_demo_meshes: could not get ${missing[*]} from the Debian package libcgal-demo; put them into $folder yourself" >&2
exit 1
