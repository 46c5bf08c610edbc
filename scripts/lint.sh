#!/usr/bin/env bash
# lint.sh [--changed] [BUILD_DIR]: clang-format over every source, clang-tidy over the sources that BUILD_DIR compiles,
# and a look at vector code.
# --changed: clang-tidy only those that differ from the last commit. BUILD_DIR defaults to build/release.
# The style is kept clean with version 14 of both tools: other versions format and warn differently, so they are not used.
set -euo pipefail
cd "$(dirname "$0")/.."

only_changed=0
if [ "${1:-}" = --changed ]; then only_changed=1; shift; fi
build_dir=${1:-build/release}
folders=()
for folder in lib tools tests examples bench viewer; do [ -d "$folder" ] && folders+=("$folder"); done
status=0

# The name of version 14 of a tool, or nothing.
tool_14() {
  local name
  for name in "$1-14" "$1"; do
    if command -v "$name" >/dev/null && "$name" --version | grep -q 'version 14\.'; then echo "$name"; return; fi
  done
}

sources() { find "${folders[@]}" \( -name '*.cpp' -o -name '*.h' \) -print | LC_ALL=C sort; }

changed() {
  { git diff --name-only --diff-filter=d HEAD; git ls-files --others --exclude-standard; } 2>/dev/null | grep '\.cpp$' || true
}

# Every compiled source of ours; with --changed, those that git says differ.
tidy_sources() {
  python3 -c '
import json, os, sys
database, root = json.load(open(sys.argv[1])), os.getcwd() + os.sep
names = {os.path.realpath(os.path.join(entry["directory"], entry["file"])) for entry in database}
print(*sorted(name[len(root):] for name in names if name.startswith(root)), sep="\n")
' "$build_dir/compile_commands.json" | if [ "$only_changed" = 1 ]; then grep -Fxf <(changed) || true; else cat; fi
}

clang_format=$(tool_14 clang-format)
if [ -n "$clang_format" ]; then
  sources | xargs -r "$clang_format" --dry-run -Werror || { echo "lint: run $clang_format -i on the files above" >&2; status=1; }
else
  echo "lint: clang-format 14 is not here: formatting not checked" >&2
fi

# A lambda does not inherit the instruction set of its function: where it is not inlined, vectors would be handed over
# wrongly without a word.
sources | xargs -r python3 -c '
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
sys.exit(status)' || status=1

# clang 14 cannot read the C++ library of every newer system.
reads_the_library() {
  local probe
  probe=$(mktemp --suffix=.cpp)
  echo '#include <chrono>
#include <filesystem>
#include <functional>
#include <ranges>
#include <span>
#include <string>
#include <variant>' >"$probe"
  "$1" --quiet --checks=-*,bugprone-infinite-loop "$probe" -- -std=c++20 >/dev/null 2>&1
  local result=$?
  rm -f "$probe"
  return $result
}

clang_tidy=$(tool_14 clang-tidy)
if [ -n "$clang_tidy" ] && ! reads_the_library "$clang_tidy"; then
  echo "lint: clang-tidy 14 cannot read this system's C++ library: sources not checked" >&2
elif [ -n "$clang_tidy" ]; then
  # The database is made for g++, which has had its say on warnings: clang does not know all of them and has others.
  tidy_sources | xargs -r -P "$(nproc)" -n 1 "$clang_tidy" -p "$build_dir" --quiet \
    --extra-arg=-Wno-unknown-warning-option --extra-arg=-Wno-error 2> >(grep -v -E '^[0-9]+ warnings? (generated|treated)' >&2) || status=1
else
  echo "lint: clang-tidy 14 is not here: sources not checked" >&2
fi
exit $status
