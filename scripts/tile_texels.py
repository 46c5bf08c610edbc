#!/usr/bin/env python3
"""Counts what a client draws of a tileset folder, by its rule, without a browser: tiles, triangles and texels from the cameras of a scene's path.
tile_texels.py FOLDER SCENE.json [--path approach] [--error 2] [--size 1024x768] [--csv FILE]
A tile is refined where its geometricError covers more than ERROR pixels at the nearest point of its box, and left out where its box is beside the view.
First come all texels and bytes of images, by the height of their tile above the finest; `coarser` ones are those of a tile's coarser images."""
import argparse
import collections
import csv
import json
import math
import pathlib
import struct


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    return [x / math.sqrt(dot(a, a)) for x in a]


def size_of(image):
    """Width and height of a PNG or JPEG."""
    if image[:4] == b"\x89PNG":
        return struct.unpack(">II", image[16:24])
    at = 2
    while not 0xFFC0 <= struct.unpack(">H", image[at : at + 2])[0] <= 0xFFC3:
        at += 2 + struct.unpack(">H", image[at + 2 : at + 4])[0]
    height, width = struct.unpack(">HH", image[at + 5 : at + 9])
    return width, height


def content_of(file):
    """Triangles, texels and bytes of images of a binary glTF file."""
    data = file.read_bytes()
    head = 20 + struct.unpack("<I", data[12:16])[0]
    gltf = json.loads(data[20:head])
    triangles = sum(gltf["accessors"][p["indices"]]["count"] // 3 for mesh in gltf["meshes"] for p in mesh["primitives"])
    texels = images = 0
    for image in gltf.get("images", []):
        view = gltf["bufferViews"][image["bufferView"]]
        first = head + 8 + view.get("byteOffset", 0)
        width, height = size_of(data[first : first + view["byteLength"]])
        texels, images = texels + width * height, images + view["byteLength"]
    return triangles, texels, images


class Tileset:
    """The tree of a tileset, external ones included, with what contents hold."""

    def __init__(self, folder):
        self.folder, self.levels = folder, collections.defaultdict(lambda: [0, 0, 0])
        self.root, _ = self.read("tileset.json")

    def read(self, name):
        return self.tile(json.loads((self.folder / name).read_text())["root"])

    def tile(self, tile):
        """A tile as (error, centre, half extents, content, children), and its height."""
        name = tile.get("content", {}).get("uri")
        if name and name.endswith(".json"):
            return self.read(name)
        below = [self.tile(child) for child in tile.get("children", [])]
        is_coarser = name is not None and "-" in pathlib.Path(name).stem
        height = max([h for _, h in below], default=-1) + (not is_coarser)
        content = content_of(self.folder / name) if name else None
        if content:
            level = self.levels[(height, is_coarser)]
            level[:] = level[0] + 1, level[1] + content[1], level[2] + content[2]
        box = tile["boundingVolume"]["box"]
        return (tile["geometricError"], box[:3], [box[3], box[7], box[11]], content, [t for t, _ in below]), height

    def drawn(self, camera, size, most_px):
        """Tiles, triangles and texels that a camera draws."""
        forwards = unit([t - e for t, e in zip(camera["target"], camera["eye"])])
        right = unit(cross(forwards, camera.get("up", [0, 1, 0])))
        up = cross(right, forwards)
        y = math.tan(math.radians(camera.get("fov_y_deg", 60)) / 2)
        x = y * size[0] / size[1]
        planes = [forwards] + [[f * slope + sign * side for f, side in zip(forwards, axis)] for slope, axis in ((x, right), (y, up)) for sign in (1, -1)]
        total, unread = [0, 0, 0], [self.root]
        while unread:
            error, centre, half, content, children = unread.pop()
            away = [c - e for c, e in zip(centre, camera["eye"])]
            if any(dot(plane, away) + dot(map(abs, plane), half) < 0 for plane in planes):
                continue
            distance = math.sqrt(sum(max(abs(a) - h, 0) ** 2 for a, h in zip(away, half)))
            if children and (content is None or error * size[1] / (2 * y) > most_px * distance):
                unread += children
            elif content:
                total = [total[0] + 1, total[1] + content[0], total[2] + content[1]]
        return total


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("scene", type=pathlib.Path)
    parser.add_argument("--path", default="approach")
    parser.add_argument("--error", type=float, default=2.0)
    parser.add_argument("--size", type=lambda text: [int(n) for n in text.split("x")], default=[1024, 768])
    parser.add_argument("--csv", type=pathlib.Path)
    options = parser.parse_args()
    tileset = Tileset(options.folder)
    for (height, is_coarser), (tiles, texels, images) in sorted(tileset.levels.items()):
        print(f"height {height}{' coarser' if is_coarser else '':8} {tiles:6} tiles {texels:12} texels {images:12} bytes")
    cameras = json.loads(options.scene.read_text())["paths"][options.path]["keys"]
    rows = [[i, *tileset.drawn(camera, options.size, options.error)] for i, camera in enumerate(cameras)]
    for row in rows:
        print("camera {} draws {} tiles, {} triangles, {} texels".format(*row))
    print("mean", *(sum(row[k] for row in rows) / len(rows) for k in (1, 2, 3)))
    if options.csv:
        with options.csv.open("w", newline="", encoding="utf-8") as file:
            csv.writer(file, lineterminator="\n").writerows([["camera", "tiles", "triangles", "texels"], *rows])


if __name__ == "__main__":
    main()
