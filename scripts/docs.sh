#!/usr/bin/env bash
# Makes the documentation as one offline site, build/docs/html/index.html: docs/ and the API reference from the public
# headers, by Doxygen, Sphinx, Breathe and MyST. Warnings are errors.
# docs.sh [--out FOLDER]   FOLDER instead of build/docs
# The first run installs the Python packages of docs/site/requirements.txt into FOLDER/venv; later ones need no network.
set -euo pipefail
cd "$(dirname "$0")/.."
root=$PWD

out=$root/build/docs
while [ $# -gt 0 ]; do
  case $1 in
    --out) out=$(realpath -m "${2:?docs.sh: --out needs a folder}"); shift 2 ;;
    *) echo "docs.sh: unknown option $1; see the head of $0" >&2; exit 2 ;;
  esac
done

command -v doxygen >/dev/null || { echo "docs.sh: doxygen is not installed: apt-get install doxygen" >&2; exit 1; }

venv=$out/venv
if ! cmp -s docs/site/requirements.txt "$venv/requirements.txt"; then
  rm -rf "$venv"
  python3 -m venv "$venv" || { echo "docs.sh: no virtual environment: apt-get install python3-venv" >&2; exit 1; }
  "$venv/bin/pip" install --quiet --disable-pip-version-check -r docs/site/requirements.txt
  cp docs/site/requirements.txt "$venv/requirements.txt"
fi

pages=$out/pages
rm -rf "$pages" "$out/html" "$out/doxygen" "$out/doctrees"  # Sphinx fails where a class has moved to another page
python3 -B docs/site/copy_pages.py "$pages"
python3 -B docs/site/run_doxygen.py "$out/doxygen"
python3 -B docs/site/api_pages.py "$out/doxygen/xml" "$pages/reference"
OCCLOD_DOXYGEN_XML=$out/doxygen/xml "$venv/bin/sphinx-build" --quiet --fail-on-warning --keep-going --conf-dir "$pages/site" \
  --doctree-dir "$out/doctrees" "$pages" "$out/html"
echo "docs.sh: $out/html/index.html"
