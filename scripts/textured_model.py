#!/usr/bin/env python3
"""Makes a large textured model of a small mesh with texture coordinates, for measurements of tiles; needs numpy.
textured_model.py MESH.obj FOLDER [--size 8192] [--subdivide 2] [--seed 1]
Charts are packed anew, each triangle becomes 4**SUBDIVIDE, vertices move by noise along their normals, and FOLDER/model.png, SIZE x SIZE texels, shows a pattern that is
a function of the place in space: a seam where it breaks is a mistake of who drew it. FOLDER/scene.json has a path that approaches it, for
scripts/check_tiles.sh. The same arguments give the same files."""
import argparse
import json
import pathlib
import struct
import zlib

import numpy as np

BAND = 256  # rows of the image that are made at once


def read(path):
    """Positions, texture coordinates, and of each triangle's corners the numbers of both."""
    positions, coordinates, corners = [], [], []
    for line in path.read_text(errors="replace").splitlines():
        kind, *rest = line.split() or [""]
        if kind == "v":
            positions.append([float(x) for x in rest[:3]])
        elif kind == "vt":
            coordinates.append([float(x) for x in rest[:2]])
        elif kind == "f":
            face = [[int(x) - 1 for x in corner.split("/")[:2]] for corner in rest]
            corners += [[face[0], face[k], face[k + 1]] for k in range(1, len(face) - 1)]
    return np.array(positions), np.array(coordinates), np.array(corners)


def components(count, corners):
    """The least texture vertex of each one's chart."""
    label = np.arange(count)
    while True:
        least = label.copy()
        for k in range(3):
            np.minimum.at(least, corners[:, k], label[corners].min(axis=1))
        least = least[least]
        if (least == label).all():
            return label
        label = least


def shelves(sizes, side, gap):
    """Corners of rectangles in rows, the highest first; None where they do not fit."""
    corners, x, y, height = np.zeros_like(sizes), 0.0, 0.0, 0.0
    for i in np.argsort(-sizes[:, 1], kind="stable"):
        if x + sizes[i, 0] + gap > side:
            x, y, height = 0.0, y + height, 0.0
        corners[i] = x + gap / 2, y + gap / 2
        x, height = x + sizes[i, 0] + gap, max(height, sizes[i, 1] + gap)
        if x > side or y + height > side:
            return None
    return corners


def packed(positions, coordinates, corners, size):
    """Texture coordinates with each chart as large as its area in space asks for, and none over another."""
    label = components(len(coordinates), corners[..., 1])
    charts, chart_of = np.unique(label, return_inverse=True)
    a, b, c = (positions[corners[:, k, 0]] for k in range(3))
    areas = np.bincount(chart_of[corners[:, 0, 1]], np.linalg.norm(np.cross(b - a, c - a), axis=1), len(charts))
    low = np.full((len(charts), 2), np.inf)
    high = -low
    np.minimum.at(low, chart_of, coordinates)
    np.maximum.at(high, chart_of, coordinates)
    extent = np.maximum(high - low, 1e-9)
    extent *= np.sqrt(np.maximum(areas, 1e-12) / extent.prod(axis=1))[:, None]
    scale = size / np.sqrt((extent.prod(axis=1)).sum())
    while (places := shelves(extent * scale, size, 8.0)) is None:
        scale *= 0.99
    return (places[chart_of] + (coordinates - low[chart_of]) / np.maximum(high - low, 1e-9)[chart_of] * extent[chart_of] * scale) / size


def subdivided(values, triangles):
    """Splits each triangle into four at the middles of its edges."""
    edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    unique, which = np.unique(edges, axis=0, return_inverse=True)
    middles = values[unique].mean(axis=1)
    ab, bc, ca = (len(values) + which.reshape(3, -1))
    a, b, c = triangles.T
    split = np.concatenate([np.stack(t, axis=1) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    return np.concatenate([values, middles]), split


def lattice(places, seed):
    """A number in [0, 1) for each place with whole coordinates."""
    x, y, z = (places[..., k].astype(np.int64).astype(np.uint32) for k in range(3))
    h = x * np.uint32(0x9E3779B1) ^ y * np.uint32(0x85EBCA77) ^ z * np.uint32(0xC2B2AE3D) ^ np.uint32(seed * 0x27D4EB2F & 0xFFFFFFFF)
    for shift, factor in ((15, 0x2C1B3C6D), (12, 0x297A2D39)):
        h = (h ^ (h >> np.uint32(shift))) * np.uint32(factor)
    return ((h ^ (h >> np.uint32(15))) >> np.uint32(8)).astype(np.float32) / np.float32(1 << 24)


def noise(places, seed):
    """Smooth noise in [0, 1) with one feature a unit."""
    cell = np.floor(places)
    t = places - cell
    t = t * t * (3 - 2 * t)
    total = np.zeros(places.shape[:-1], np.float32)
    for corner in np.ndindex(2, 2, 2):
        weight = np.prod(np.where(np.array(corner), t, 1 - t), axis=-1)
        total += weight.astype(np.float32) * lattice(cell + np.array(corner), seed)
    return total


def colors(places, seed):
    """The pattern at places in units of a hundredth of the model."""
    clouds = sum(noise(places * 2**k, seed + k) / 2 ** (0.6 * k + 1) for k in range(6))[..., None]
    rgb = np.array([0.75, 0.55, 0.40]) * clouds + np.array([0.05, 0.20, 0.35]) * noise(places / 4, seed + 9)[..., None]
    lines = np.abs(places / 3 - np.round(places / 3)).min(axis=-1) < 0.03
    return np.uint8(np.clip(255 * np.where(lines[..., None], 0.25 * rgb, 1.4 * rgb), 0, 255))


def places_of(size, positions, coordinates, corners):
    """The place in space of each texel that a triangle shows, and of two more around it; NaN elsewhere."""
    places = np.full((size, size, 3), np.nan, np.float32)
    texels = coordinates * size
    texels[:, 1] = size - texels[:, 1]
    for corner in corners:
        a, b, c = texels[corner[:, 1]]
        area = (b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0]
        if area == 0:
            continue
        low = np.maximum(np.floor(np.minimum(np.minimum(a, b), c)).astype(int) - 2, 0)
        high = np.minimum(np.ceil(np.maximum(np.maximum(a, b), c)).astype(int) + 3, size)
        x, y = np.meshgrid(np.arange(low[0], high[0]) + 0.5, np.arange(low[1], high[1]) + 0.5)
        v = ((x - a[0]) * (c - a)[1] - (y - a[1]) * (c - a)[0]) / area
        w = ((y - a[1]) * (b - a)[0] - (x - a[0]) * (b - a)[1]) / area
        longest = max(np.hypot(*(b - a)), np.hypot(*(c - a)), np.hypot(*(c - b)))
        margin = 2.5 * longest / abs(area)  # in barycentric coordinates, of two texels
        inside = np.minimum(np.minimum(v, w), 1 - v - w)
        block = places[low[1]:high[1], low[0]:high[0]]
        take = (inside > -margin) & ((inside >= 0) | np.isnan(block[..., 0]))
        p, q, r = positions[corner[:, 0]]
        block[take] = (p + v[take, None] * (q - p) + w[take, None] * (r - p)).astype(np.float32)
    return places


def write_png(path, size, rows):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    packer, packed = zlib.compressobj(6), []
    last = np.zeros((1, 3 * size), np.uint8)
    for band in rows:
        band = band.reshape(len(band), -1)
        up = np.concatenate([np.full((len(band), 1), 2, np.uint8), band - np.concatenate([last, band[:-1]])], axis=1)
        packed.append(packer.compress(up.tobytes()))
        last = band[-1:]
    packed.append(packer.flush())
    head = struct.pack(">IIBBBBB", size, size, 8, 2, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", b"".join(packed)) + chunk(b"IEND", b""))


def displaced(positions, triangles, extent, seed):
    normals = np.zeros_like(positions)
    a, b, c = (positions[triangles[:, k]] for k in range(3))
    for k in range(3):
        np.add.at(normals, triangles[:, k], np.cross(b - a, c - a))
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    at = positions * (100 / extent)
    height = sum((noise(at * 2**k, seed + 20 + k) - 0.5) / 2**k for k in range(3))
    return positions + normals * height[:, None] * (extent / 400)


def write_scene(path, low, high):
    """The model, and a path of 12 cameras that approaches its upper half from two and a half times its extent, y up."""
    extent, target = (high - low).max(), (low + high) / 2 + [0, 0.1 * (high - low)[1], 0]
    keys = []
    for i in range(12):
        distance, turn = 2.5 * extent * 0.72**i, 0.5 + 0.12 * i
        away = np.array([np.sin(turn), 0.15, np.cos(turn)]) * distance
        keys.append({"eye": list(np.round(target + away, 6)), "target": list(np.round(target, 6)), "up": [0, 1, 0], "fov_y_deg": 50})
    path.write_text(json.dumps({"objects": [{"mesh": "model.obj"}], "cameras": {"default": keys[0]}, "paths": {"approach": {"frames": 12, "keys": keys}}}))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("mesh", type=pathlib.Path)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--size", type=int, default=8192)
    parser.add_argument("--subdivide", type=int, default=2)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    positions, coordinates, corners = read(options.mesh)
    extent = np.ptp(positions, axis=0).max()
    coordinates = packed(positions, coordinates, corners, options.size)

    places = places_of(options.size, positions, coordinates, corners)
    bands = (places[y:y + BAND] for y in range(0, options.size, BAND))
    empty = np.uint8([0, 0, 0])
    write_png(options.folder / "model.png", options.size,
              (np.where(np.isnan(band[..., :1]), empty, colors(np.nan_to_num(band) * (100 / extent), options.seed)) for band in bands))
    del places

    faces, texture_faces = corners[..., 0], corners[..., 1]
    for _ in range(options.subdivide):
        positions, faces = subdivided(positions, faces)
        coordinates, texture_faces = subdivided(coordinates, texture_faces)
    positions = displaced(positions, faces, extent, options.seed)
    (options.folder / "model.mtl").write_text("newmtl model\nmap_Kd model.png\n")
    with open(options.folder / "model.obj", "w", encoding="utf-8") as file:
        file.write("mtllib model.mtl\nusemtl model\n")
        np.savetxt(file, positions, "v %.6f %.6f %.6f")
        np.savetxt(file, coordinates, "vt %.8f %.8f")
        pairs = np.stack([faces + 1, texture_faces + 1], axis=2).reshape(len(faces), 6)
        np.savetxt(file, pairs, "f %d/%d %d/%d %d/%d")
    write_scene(options.folder / "scene.json", positions.min(axis=0), positions.max(axis=0))
    print(f"{len(faces)} triangles, {options.size} x {options.size} texels")


if __name__ == "__main__":
    main()
