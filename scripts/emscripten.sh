#!/usr/bin/env bash
# emscripten.sh: prints the folder that has emcc, emcmake and the rest of Emscripten, 3.1.69 or later. That of the system where it
# is new enough; else Debian 13's package, unpacked in build/emscripten and run by the compiler of scripts/packages_web.txt.
# Exit status 77 where it cannot be had.
set -euo pipefail
cd "$(dirname "$0")/.."

oldest=3.1.69
work=$PWD/build/emscripten
root=$work/debian13
tools=$root/usr/share/emscripten

skip() { echo "emscripten: SKIPPED: $1" >&2; exit 77; }

if version=$(emcc -dumpversion 2>/dev/null) && [ "$(printf '%s\n' "$oldest" "$version" | sort -V | head -n 1)" = "$oldest" ]; then
  dirname "$(command -v emcc)"
  exit 0
fi
if [ -e "$work/complete" ]; then
  echo "$tools"
  exit 0
fi
command -v apt-get >/dev/null && [ "$(dpkg --print-architecture)" = amd64 ] || skip "no Emscripten $oldest here, and no apt for Debian 13's"
command -v node >/dev/null || skip "Node is missing"
scripts/setup.sh scripts/packages_web.txt || skip "the packages of scripts/packages_web.txt cannot be installed"

rm -rf "$work"
mkdir -p "$root" "$work/packages"
(cd "$work/packages" && "$OLDPWD/scripts/debian_apt.sh" trixie download emscripten binaryen node-acorn libc6 libstdc++6 libgcc-s1) >"$work/log" ||
  skip "Debian 13's packages cannot be had: see $work/log"
for package in "$work"/packages/*.deb; do dpkg-deb -x "$package" "$root"; done
rm -r "$work/packages" "$tools"/cache/sysroot/lib/wasm32-emscripten/{lto,lto-pic,pic}  # three quarters of it

# Binaryen's programs run with the C library for which they were compiled.
libraries=$root/usr/lib/x86_64-linux-gnu
mkdir -p "$root/binaryen/bin"
for program in "$root"/usr/bin/wasm-*; do
  wrapper=$root/binaryen/bin/$(basename "$program")
  printf '#!/bin/sh\nexec "%s" --library-path "%s" "%s" "$@"\n' "$libraries/ld-linux-x86-64.so.2" "$libraries" "$program" >"$wrapper"
  chmod +x "$wrapper"
done
ln -s "$root/usr/share/nodejs" "$tools/node_modules"
sed -i -e "s|^BINARYEN_ROOT = .*|BINARYEN_ROOT = '$root/binaryen'|" -e "s|^NODE_JS = .*|NODE_JS = '$(command -v node)'|" "$tools/.emscripten"
touch "$work/complete"
echo "$tools"
