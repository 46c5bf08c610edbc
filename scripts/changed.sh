#!/usr/bin/env bash
# changed.sh: the files that differ from the main branch, committed or not, one a line; deleted ones left out.
# The main branch: OCCLOD_MAIN, or the first of origin/main and main that there is.
set -euo pipefail
cd "$(dirname "$0")/.."

base=HEAD
for name in ${OCCLOD_MAIN:-origin/main main}; do
  if git rev-parse --verify --quiet "$name^{commit}" >/dev/null; then base=$(git merge-base HEAD "$name"); break; fi
done
{ git diff --name-only --diff-filter=d "$base"; git ls-files --others --exclude-standard; } | LC_ALL=C sort -u
