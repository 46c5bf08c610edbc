#!/usr/bin/env python3
"""blender_extension.py WHEEL [--output FOLDER]: the extension of packaging/blender with a wheel of the Python package inside, as
a zip that Blender installs from disk, in FOLDER (build/blender). The wheel is for Blender's own version of Python: cp311 for
Blender 4.2 to 5.0."""
import argparse
import pathlib
import sys
import zipfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
SOURCE = ROOT / "packaging/blender"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("wheel", type=pathlib.Path)
    parser.add_argument("--output", type=pathlib.Path, default=ROOT / "build/blender")
    arguments = parser.parse_args()
    wheel = arguments.wheel
    if wheel.suffix != ".whl" or not wheel.is_file():
        sys.exit(f"blender_extension: {wheel}: is no wheel; build one (pip wheel --no-deps .)")
    name, version, _, abi, platform = wheel.stem.rsplit("-", 4)
    result = arguments.output / f"{name}-blender-{version}-{abi}-{platform}.zip"
    result.parent.mkdir(parents=True, exist_ok=True)
    manifest = (SOURCE / "blender_manifest.toml").read_text(encoding="utf-8")
    with zipfile.ZipFile(result, "w", zipfile.ZIP_DEFLATED) as archive:
        for path in sorted(SOURCE.glob("*.py")):
            archive.write(path, path.name)
        archive.writestr("blender_manifest.toml", f'{manifest}wheels = ["./wheels/{wheel.name}"]\n')
        archive.write(ROOT / "LICENSE", "LICENSE")
        archive.write(wheel, f"wheels/{wheel.name}")
    print(result)


if __name__ == "__main__":
    main()
