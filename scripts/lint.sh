#!/usr/bin/env bash
# lint.sh [--changed | --fresh] [BUILD_DIR]: clang-format over every source, clang-tidy over the sources that BUILD_DIR
# compiles (scripts/tidy.py), and a look at vector code. BUILD_DIR defaults to build/release.
#   --changed  only what differs from the main branch; a header is looked at through a source that includes it
#   --fresh    sources that were clean and have not changed since are read again
# Exit: 0 clean, 1 something was found, 77 nothing was found but something could not be checked. The last line says which.
# The style is kept clean with version 14 of both tools: other versions format and warn differently, so they are not used.
set -euo pipefail
cd "$(dirname "$0")/.."

only_changed=0
tidy_options=()
case ${1:-} in
  --changed) only_changed=1; shift ;;
  --fresh) tidy_options+=(--fresh); shift ;;
  -*) echo "lint.sh: unknown option $1; see the head of $0" >&2; exit 2 ;;
esac
build_dir=${1:-build/release}
failed=0
skipped=()

# The name of version 14 of a tool, or nothing.
tool_14() {
  local name
  for name in "$1-14" "$1"; do
    if command -v "$name" >/dev/null && "$name" --version | grep -q 'version 14\.'; then echo "$name"; return; fi
  done
}

sources() {
  if [ "$only_changed" = 1 ]; then
    scripts/changed.sh
  else
    find bench examples lib packaging python tests tools viewer -type f
  fi | grep -E '^(bench|examples|lib|packaging|python|tests|tools|viewer)/.*\.(cpp|h)$' | LC_ALL=C sort || true
}
mapfile -t sources < <(sources)

clang_format=$(tool_14 clang-format)
if [ -z "$clang_format" ]; then
  skipped+=("formatting (no clang-format 14)")
elif [ ${#sources[@]} -gt 0 ]; then
  printf '%s\0' "${sources[@]}" | xargs -0 "$clang_format" --dry-run -Werror ||
    { echo "lint: run $clang_format -i on the files above" >&2; failed=1; }
fi

# A lambda does not inherit the instruction set of its function: where it is not inlined, vectors would be handed over
# wrongly without a word.
[ ${#sources[@]} -eq 0 ] || python3 -c '
import re, sys
status = 0
for name in sys.argv[1:]:
    text = open(name, encoding="utf-8").read()
    for part in re.finditer(r"HWY_BEFORE_NAMESPACE\(\);.*?HWY_AFTER_NAMESPACE\(\);", text, re.S):
        for found in re.finditer(r"\[[^\[\]]*\]\s*\([^()]*\)\s*(HWY_ATTR\b)?\s*(?=\{)", part[0]):
            if not found[1]:
                line = text[:part.start() + found.start()].count("\n") + 1
                print(f"{name}:{line}: lint: a lambda among vectors without HWY_ATTR", file=sys.stderr)
                status = 1
sys.exit(status)' "${sources[@]}" || failed=1

# clang 14 cannot read the C++ library of every newer system.
reads_the_library() {
  local probe result=0
  probe=$(mktemp --suffix=.cpp)
  printf '#include <%s>\n' chrono filesystem functional ranges span string variant >"$probe"
  "$1" --quiet --checks=-*,bugprone-infinite-loop "$probe" -- -std=c++20 >/dev/null 2>&1 || result=1
  rm -f "$probe"
  return $result
}

clang_tidy=$(tool_14 clang-tidy)
if [ -z "$clang_tidy" ]; then
  skipped+=("clang-tidy's checks (no clang-tidy 14)")
elif [ ! -f "$build_dir/compile_commands.json" ]; then
  skipped+=("clang-tidy's checks ($build_dir is not configured)")
elif ! reads_the_library "$clang_tidy"; then
  skipped+=("clang-tidy's checks (clang-tidy 14 cannot read this system's C++ library)")
elif [ "$only_changed" = 0 ]; then
  python3 -B scripts/tidy.py "$clang_tidy" "$build_dir" "${tidy_options[@]}" || failed=1
elif [ ${#sources[@]} -gt 0 ]; then
  python3 -B scripts/tidy.py "$clang_tidy" "$build_dir" --only "${sources[@]}" || failed=1
fi

if [ "$failed" = 1 ]; then echo "lint: failed"; exit 1; fi
if [ ${#skipped[@]} -gt 0 ]; then
  list=$(printf ', %s' "${skipped[@]}")
  echo "lint: SKIPPED ${list:2}"
  exit 77
fi
echo "lint: clean"
