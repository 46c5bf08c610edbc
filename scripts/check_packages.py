#!/usr/bin/env python3
"""check_packages.py BUILD_DIR: every system header that our sources include and every system library that the build links
comes from a package of scripts/packages.txt, or from what its C++ compiler needs anyway. Prints what is missing; exit 1 then."""
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
FOLDERS = ["lib", "tools", "tests", "examples", "bench", "viewer"]
INCLUDE = re.compile(r"^\s*#\s*include\s+[<\"]([^>\"]+)[>\"]", re.M)


def listed_packages():
    lines = (ROOT / "scripts/packages.txt").read_text().splitlines()
    return {line.split("#")[0].split()[0] for line in lines if line.split("#")[0].strip()}


def output_of(*command):
    return subprocess.run(command, check=False, capture_output=True, text=True).stdout


def closure(package):
    """A package and everything that it depends on, by name without the architecture."""
    names, todo = set(), [package]
    while todo:
        name = todo.pop()
        if name in names:
            continue
        names.add(name)
        depends = output_of("dpkg-query", "-W", "-f=${Depends}, ${Pre-Depends}", name)
        todo += [re.split(r"[ :(]", entry.strip())[0] for entry in re.split(r"[,|]", depends) if entry.strip()]
    return names


def with_versions(packages):
    """With the packages that some of them stand for: libboost1.74-dev for libboost-dev, of which each release has its own."""
    depends = {name: output_of("dpkg-query", "-W", "-f=${Depends}", name) for name in packages}
    versioned = {re.split(r"[ :(]", entry.strip())[0]: name for name, entries in depends.items() for entry in entries.split(",")}
    return packages | {package for package, name in versioned.items() if re.sub(r"\d[\d.]*", "", package) == name}


def header_dependencies(build_dir):
    """Every header outside the project that the build has read, as ninja noted it."""
    deps = output_of("ninja", "-C", str(build_dir), "-t", "deps")
    return {line.strip() for line in deps.splitlines() if line.startswith("    /usr/")}


def included_headers(build_dir):
    """Those that our own sources name, with the first of our sources that does."""
    included = {}
    for folder in FOLDERS:
        for source in sorted((ROOT / folder).rglob("*.[ch]*")):
            if source.suffix in {".h", ".cpp"}:
                for name in INCLUDE.findall(source.read_text()):
                    included.setdefault(name, str(source.relative_to(ROOT)))
    found = {}
    for path in header_dependencies(build_dir):
        parts = pathlib.PurePath(path).parts
        for length in range(1, len(parts)):
            name = "/".join(parts[-length:])
            if name in included:
                found.setdefault(path, included[name])
    return found


def linked_libraries(build_dir):
    """By the names without a version, which development packages hold."""
    text = (build_dir / "build.ninja").read_text()
    paths = re.findall(r"(?<=\s)(/usr/\S+\.(?:so|a))(?:\.\d+)*(?=\s)", text)
    return {path: "a link line" for path in paths}


def packages_of(paths):
    """Maps each path to its package, names without the architecture; files that no package owns are left out."""
    owners = {}
    for line in output_of("dpkg", "-S", *paths).splitlines():
        packages, path = line.split(": ", 1)
        owners[path] = packages.split(", ")[0].split(":")[0]
    return owners


def main():
    build_dir = pathlib.Path(sys.argv[1]).resolve()
    users = included_headers(build_dir) | linked_libraries(build_dir)
    if not users:
        sys.exit(f"check_packages: {build_dir} has not been built with ninja")
    listed = listed_packages()
    granted = with_versions(listed) | closure("g++")
    missing = {}
    for path, package in sorted(packages_of(sorted(users)).items()):
        if package not in granted:
            missing.setdefault(package, (path, users[path]))
    for package, (path, user) in missing.items():
        print(f"scripts/packages.txt lacks {package}: {user} uses {path}")
    print(f"{len(users)} headers and libraries, {len(missing)} packages missing")
    sys.exit(1 if missing else 0)


if __name__ == "__main__":
    main()
