#!/usr/bin/env python3
"""Copies docs/ for Sphinx, with the Markdown files outside of it that belong to the site, and changes links accordingly.

copy_pages.py OUTPUT_FOLDER  Links to public headers become links to their pages of the reference.
"""
import os
import pathlib
import re
import shutil
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
OTHERS = {"CHANGELOG.md": "changelog.md", "CONTRIBUTING.md": "contributing.md", "meshes/README.md": "meshes.md",
          "bench/results/README.md": "results.md"}
LINK = re.compile(r"(\]\()([^)\s]+)\)")
HEADER = re.compile(r"lib/include/occlod/(.+)\.h$")


def place_in_site(path):
    """Where the site has a file of the repository, as a path relative to its root, or None."""
    header = HEADER.match(path)
    if header:
        return f"reference/{header.group(1)}.md"
    return OTHERS.get(path) or (path.removeprefix("docs/") if path.startswith("docs/") else None)


def with_links_of_the_site(text, source, page, output):
    """The text of the repository's file `source`, to be put at `page` of the site in the folder `output`."""
    def change(link):
        file, hash_sign, anchor = link.group(2).partition("#")
        if not file or re.match(r"[a-z]+:", file):
            return link.group()
        path = os.path.normpath(os.path.join(os.path.dirname(source), file))
        place = place_in_site(path)
        folder = output / os.path.dirname(page)
        target = os.path.relpath(output / place if place else ROOT / path, folder)
        return f"{link.group(1)}{target}{hash_sign}{anchor})"
    return LINK.sub(change, text)


def copy_pages(output):
    shutil.copytree(ROOT / "docs", output, ignore=shutil.ignore_patterns("*.md", "__pycache__"))
    sources = [str(path.relative_to(ROOT)) for path in (ROOT / "docs").rglob("*.md")]
    for source in [*sources, *OTHERS]:
        page = place_in_site(source)
        path = output / page
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(with_links_of_the_site((ROOT / source).read_text(encoding="utf-8"), source, page, output), encoding="utf-8")


if __name__ == "__main__":
    copy_pages(pathlib.Path(sys.argv[1]).resolve())
