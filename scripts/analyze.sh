#!/usr/bin/env bash
# analyze.sh [FILE...]: Clang's static analyser (version 14, the checks clang-analyzer-*) over the sources of lib/, tools/ and viewer/
# that build/release compiles, or over the named ones. It walks the paths through every function, which takes several times as
# long as lint.sh; so it is no part of test.sh. Sources without findings are read again only when they change.
# Exit: 0 nothing found, 1 something, 77 clang-tidy 14 is not here.
set -euo pipefail
cd "$(dirname "$0")/.."

for clang_tidy in clang-tidy-14 clang-tidy none; do
  if command -v "$clang_tidy" >/dev/null && "$clang_tidy" --version | grep -q 'version 14\.'; then break; fi
done
if [ "$clang_tidy" = none ]; then echo "analyze: SKIPPED (no clang-tidy 14)"; exit 77; fi

files=("$@")
[ ${#files[@]} -gt 0 ] || mapfile -t files < <(find lib tools viewer -name '*.cpp' | LC_ALL=C sort)
python3 -B scripts/tidy.py "$clang_tidy" build/release --analyze --only "${files[@]}" || { echo "analyze: failed"; exit 1; }
echo "analyze: nothing found"
