#!/usr/bin/env bash
# check_recipes.sh [conan|debian]: makes the packages of packaging/ from what git tracks, in build/recipes. Both without an
# argument. Says SKIPPED, with exit status 77, where the tools are missing: conan (pip install conan); dpkg-dev, debhelper,
# lintian and the Build-Depends of packaging/debian/control. packaging/vcpkg needs vcpkg's own registry, so it is not run here.
set -euo pipefail
cd "$(dirname "$0")/.."

work=$PWD/build/recipes
status=0
skip() { echo "check_recipes: SKIPPED $1: $2" >&2; status=77; }

# The tree as git has it, with what is not committed.
copy_tree() {
  rm -rf "$1"
  mkdir -p "$1"
  git ls-files -z --cached --others --exclude-standard | xargs -0 --no-run-if-empty cp --parents --target-directory="$1"
}

# With the distribution's packages, so that it runs without Conan Center.
check_conan() {
  if ! command -v conan >/dev/null; then skip conan "no conan here"; return; fi
  export CONAN_HOME=$work/conan-home
  conan profile detect --force >/dev/null 2>&1
  copy_tree "$work/conan"
  local shared
  for shared in False True; do
    conan create "$work/conan/packaging/conan" --no-remote -s compiler.cppstd=20 -o "&:shared=$shared" -o "&:system_packages=True"
  done
}

check_debian() {
  if ! command -v dpkg-buildpackage >/dev/null || ! command -v lintian >/dev/null; then
    skip debian "no dpkg-buildpackage or no lintian here"
    return
  fi
  local version tree
  version=$(sed -n '1s/.*(\(.*\)-.*).*/\1/p' packaging/debian/changelog)
  tree=$work/debian/occlod-$version
  copy_tree "$tree"
  tar -C "$work/debian" --exclude-vcs -cJf "$work/debian/occlod_$version.orig.tar.xz" "occlod-$version"
  cp -r "$tree/packaging/debian" "$tree/debian"
  if ! (cd "$tree" && dpkg-checkbuilddeps); then skip debian "build dependencies are missing"; return; fi
  (cd "$tree" && dpkg-buildpackage -us -uc)
  # Nobody has asked Debian for this package.
  lintian --suppress-tags initial-upload-closes-no-bugs --fail-on error,warning "$work/debian/"*.changes
}

if [ $# -eq 0 ] || [ "$1" = conan ]; then check_conan; fi
if [ $# -eq 0 ] || [ "$1" = debian ]; then check_debian; fi
exit $status
