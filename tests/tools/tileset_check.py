#!/usr/bin/env python3
"""tileset_check.py TILESET [--json]: checks a tileset of `occlod tiles`, a folder or an archive (.3tz, by archive_check.py), against every rule of 3D Tiles 1.1 and glTF 2.0 that it makes use of, and
against what docs/guide/tiles.md promises. Independent of our own code: it reads the bytes with Python's library. Whatever is wrong ends in exit 1 and
one line on standard error: the file, the place in it, the problem. Contents: glb_check.py."""
import json
import os.path
import pathlib
import sys
import tempfile
import urllib.parse

from archive_check import Archive
from glb_check import Glb
from json_place import Place, Wrong, parse, quoted

TILE_KEYS = {"boundingVolume", "geometricError", "refine", "transform", "content", "children"}
SLACK = 1e-9  # of the largest coordinate, for sums of centres and half axes


def box_of(volume):
    """(min, max) of a boundingVolume: our boxes are aligned with the axes."""
    place = volume.object(["box"], [])["box"]
    box = place.numbers(12)
    for axis in range(3):
        for row in range(3):
            value = box[3 + 3 * axis + row]
            place.require(value > 0 if axis == row else value == 0, "has a half axis that is flat, mirrored or not along an axis")
    return tuple(box[k] - box[3 + 4 * k] for k in range(3)), tuple(box[k] + box[3 + 4 * k] for k in range(3))


def is_inside(inner, outer):
    slack = SLACK * max(map(abs, (*outer[0], *outer[1], 1e-300)))
    return all(inner[0][k] >= outer[0][k] - slack and inner[1][k] <= outer[1][k] + slack for k in range(3))


def error_of(tile):
    place = tile["geometricError"]
    error = place.number()
    place.require(error >= 0, "is below 0")
    return error


def check_transform(place):
    matrix = place.numbers(16)
    columns = [matrix[4 * k:4 * k + 4] for k in range(4)]
    place.require([column[3] for column in columns] == [0, 0, 0, 1], "is not affine")
    x, y, z = (column[:3] for column in columns[:3])
    for a, b, dot in ((x, x, 1), (y, y, 1), (z, z, 1), (x, y, 0), (y, z, 0), (x, z, 0)):
        place.require(abs(sum(p * q for p, q in zip(a, b)) - dot) < 1e-12, "does more than rotate and move")
    cross = [x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]]
    place.require(sum(p * q for p, q in zip(cross, z)) > 0, "mirrors")


class Checker:
    def __init__(self, folder, max_tiles=None):
        self.folder = pathlib.Path(folder).resolve()
        self.max_tiles = max_tiles
        self.found = {"tilesets": 0, "tiles": 0, "contents": 0, "leaves": 0, "triangles": 0, "leaf_triangles": 0, "content_bytes": 0, "depth": 0}
        self.seen = set()

    def run(self):
        todo = [(Place("tileset.json", "tileset.json"), None, None, 0)]
        while todo:
            todo += self.tileset(*todo.pop())
        files = {path.relative_to(self.folder).as_posix() for path in self.folder.rglob("*") if path.is_file()}
        for name in sorted(files - self.seen):
            Place(None, name).require(name.startswith("textures/"), "is not part of the tileset")
        return self.found

    def open(self, uri, base):
        """The path of what a place names, and its name in the folder; each file once."""
        text = uri.text()
        uri.require("://" not in text and not text.startswith("/") and "\\" not in text, f"{quoted(text)} is no relative uri")
        try:
            path = (base / urllib.parse.unquote(text)).resolve()
            uri.require(path.is_relative_to(self.folder), f"{quoted(text)} leaves the folder")
            is_there = path.is_file()
        except (OSError, RuntimeError, ValueError):  # too long, links in a circle, bytes that no path may have
            is_there = False
        uri.require(is_there, f"{quoted(text)} is not there")
        name = path.relative_to(self.folder).as_posix()
        uri.require(name not in self.seen, f"{quoted(text)} is used twice")
        self.seen.add(name)
        return path, name

    def tileset(self, uri, parent, parent_error, depth):
        """Checks one file; what tileset() takes for each external tileset that it names."""
        path, name = self.open(uri, self.folder)
        try:
            data = path.read_bytes()
        except OSError as error:
            uri.fail(f"{quoted(name)} cannot be read: {error.strerror}")
        tileset = parse(data, name).object(["asset", "geometricError", "root"], [])
        version = tileset["asset"].object(["version", "extras"], [])["version"]
        version.require(version.value == "1.1", "is not 1.1")
        self.found["tilesets"] += 1
        root = tileset["root"]
        root.require("refine" in root and root["refine"].value == "REPLACE", "does not say refine: REPLACE")
        tileset["geometricError"].require(tileset["geometricError"].number() >= error_of(root), "is not above the root's")
        if parent is not None:  # repeats the tile that refers to it
            root.require(error_of(root) == parent_error and box_of(root["boundingVolume"]) == parent, "is not the tile that refers to it")
        externals, tiles, in_file = [], [(root, None, None, depth)], 0
        while tiles:
            tiles += self.tile(*tiles.pop(), path.parent, externals, is_root=in_file == 0)
            in_file += 1
        tileset.require(self.max_tiles is None or in_file <= self.max_tiles, f"holds {in_file} tiles")
        return externals

    def tile(self, tile, parent_box, parent_error, depth, base, externals, is_root):
        """Checks one tile; the first four arguments for each child. Appends what tileset() takes to `externals`."""
        tile.object(["boundingVolume", "geometricError"], TILE_KEYS)
        self.found["depth"] = max(self.found["depth"], depth)
        tile.require(is_root or ("refine" not in tile and "transform" not in tile), "is below the root and has refine or transform")
        if "transform" in tile:
            check_transform(tile["transform"])
        box, error = box_of(tile["boundingVolume"]), error_of(tile)
        tile["geometricError"].require(parent_error is None or error < parent_error, "is not less than the parent's")
        tile["boundingVolume"].require(parent_box is None or is_inside(box, parent_box), "leaves the parent's")
        children = tile["children"].list() if "children" in tile else []
        tile.require(children or "children" not in tile, "has an empty list of children")
        tile.require("content" in tile or children, "is a leaf without content")
        if "content" in tile:
            uri = tile["content"]["uri"]
            if uri.text().endswith(".json"):
                tile["content"].object(["uri"], [])
                tile.require(not children, "has an external tileset and children")
                externals.append((uri, box, error, depth))
                return []
            self.content(tile["content"], box, base, is_leaf=not children)
        tile["geometricError"].require(bool(children) == (error > 0), "is 0 above children, or not 0 at a leaf")
        self.found["tiles"] += 1
        return [(child, box, error, depth + 1) for child in reversed(children)]

    def content(self, content, tile_box, base, is_leaf):
        volume = content.object(["uri", "boundingVolume"], [])["boundingVolume"]
        box = box_of(volume)
        volume.require(is_inside(box, tile_box), "leaves the tile's")
        path, name = self.open(content["uri"], base)
        glb = Glb(path, name)
        low, high = glb.low, glb.high
        volume.require(is_inside((low, high), box), f"vertices of {quoted(name)} leave it")
        thickness = 2e-6 * max(*(high[k] - low[k] for k in range(3)), 1e-6 * max(map(abs, (*low, *high)))) + 1e-6 * (low == high)
        for k in range(3):
            slack = thickness + SLACK * max(abs(low[k]), abs(high[k]))
            volume.require(box[0][k] >= low[k] - slack and box[1][k] <= high[k] + slack, f"is not tight around {quoted(name)}")
        self.found["contents"] += 1
        self.found["leaves"] += is_leaf
        self.found["triangles"] += glb.triangles
        self.found["leaf_triangles"] += glb.triangles * is_leaf
        self.found["content_bytes"] += path.stat().st_size


def check(tileset, max_tiles=None):
    """What was found, as a dictionary; raises Wrong."""
    if pathlib.Path(tileset).suffix.lower() != ".3tz" or not pathlib.Path(tileset).is_file():
        return Checker(tileset, max_tiles).run()
    archive = Archive(tileset)
    with tempfile.TemporaryDirectory(prefix="occlod-archive-") as folder:
        for name in archive.names:
            path = pathlib.Path(folder, name)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(archive.read(name))
        return Checker(folder, max_tiles).run()


def main():
    folders = [argument for argument in sys.argv[1:] if not argument.startswith("--")]
    if len(folders) != 1:
        sys.exit("usage: tileset_check.py TILESET [--json]")
    try:
        found = check(folders[0])
    except Wrong as error:
        sys.exit(os.path.join(folders[0], str(error)))
    print(json.dumps(found) if "--json" in sys.argv else "\n".join(f"{key:16} {value}" for key, value in found.items()))


if __name__ == "__main__":
    main()
