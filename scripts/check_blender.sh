#!/usr/bin/env bash
# check_blender.sh [WHEEL]: makes the extension of packaging/blender with that wheel of the Python package, or one that is built
# here, has Blender validate it, and runs tests/python/test_blender.py with it installed in Blender's own Python module (bpy,
# from the package registry: 350 MB to download). Needs Python 3.11, named by OCCLOD_PYTHON if it is not python3.11, and Blender's
# libraries (apt-get install libgl1 libsm6 libxfixes3 libxi6 libxkbcommon0 libxrender1 libxxf86vm1).
# Works in build/blender. Says SKIPPED, with exit status 77, where something cannot be had.
set -euo pipefail
cd "$(dirname "$0")/.."

python=${OCCLOD_PYTHON:-python3.11}
work=$PWD/build/blender
skip() { echo "check_blender: SKIPPED: $1" >&2; exit 77; }

[ "$("$python" -c 'import ensurepip, sys; print("%d.%d" % sys.version_info[:2])' 2>/dev/null)" = 3.11 ] ||
  skip "$python is not Python 3.11 with venv, which Blender 4.2 has"
mkdir -p "$work"
[ -x "$work/env/bin/pip" ] || "$python" -m venv "$work/env"
"$work/env/bin/pip" install -q --disable-pip-version-check "$(grep '^bpy==' tests/python/requirements.txt)" ||
  skip "the package registry does not answer"
blender=$("$work/env/bin/python" -c 'import bpy; print(bpy.utils.system_resource("SCRIPTS"))') || skip "bpy does not start"

wheel=${1:-}
if [ -z "$wheel" ]; then
  rm -rf "$work/wheel"
  if command -v ccache >/dev/null; then export CMAKE_C_COMPILER_LAUNCHER=ccache CMAKE_CXX_COMPILER_LAUNCHER=ccache; fi
  "$work/env/bin/pip" wheel -q --disable-pip-version-check --no-deps -w "$work/wheel" .
  wheel=$(echo "$work/wheel"/*.whl)
fi
extension=$(scripts/blender_extension.py "$wheel")
"$work/env/bin/python" "$blender/addons_core/bl_pkg/cli/blender_ext.py" validate "$extension"
rm -rf "$work/user"
export BLENDER_USER_RESOURCES=$work/user OCCLOD_BLENDER_EXTENSION=$extension  # not the user's own Blender
(cd tests/python && "$work/env/bin/python" -B -m unittest -v test_blender)
echo "check_blender: passed"
