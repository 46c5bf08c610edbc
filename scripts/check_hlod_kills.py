#!/usr/bin/env python3
"""check_hlod_kills.py OCCLOD FOLDER [--cells 3200] [--texels 8192] [--memory 1G] [--kills 20] [--seed 1]: a textured HLOD of a model like those of photogrammetry,
larger than memory, that is killed at random moments again and again and resumed each time has the bytes of a build that was left alone, on one thread and on all; and so
has its tileset. Writes all files into FOLDER, 2 * CELLS^2 triangles as FOLDER/terrain.obj (70 bytes each) unless that is there: rough ground with walls and holes, in
charts of 64 x 64 cells, which fill 16 images of TEXELS x TEXELS. Prints peak memory, bytes and times. Needs numpy and Pillow."""
import argparse
import json
import math
import pathlib
import random
import subprocess
import time

import numpy as np
import PIL.Image

CHART = 64  # cells along each side
IMAGES = 16
GAP = 8  # texels between charts


def heights(rows, cells, seed):
    """Of these rows of vertices: hills with all wavelengths down to two cells, walls, and noise as of a scanner."""
    y, x = np.meshgrid(rows, np.arange(cells + 1), indexing="ij")
    total = np.zeros(x.shape)
    random_ = np.random.default_rng(seed)
    for wavelength in 2.0 ** np.arange(3, 12):
        a, b, c, d = random_.uniform(0, 2 * np.pi, 4)
        total += 0.08 * wavelength * np.sin(x * np.cos(a) * 6 / wavelength + b) * np.sin(y * np.cos(c) * 6 / wavelength + d)
    total += np.where((x // 97 + y // 61) % 5 == 0, 40.0, 0.0)  # walls
    noise = np.stack([np.random.default_rng((seed, int(row))).normal(0, 0.1, cells + 1) for row in rows])
    return total + noise


def octave(random_, size, step):
    """Noise in [0, 1) that changes every `step` texels, linear between."""
    lattice = random_.random((size // step + 2,) * 2, np.float32)
    at, part = np.divmod(np.arange(size, dtype=np.float32) / np.float32(step), 1)
    at = at.astype(int)
    rows = lattice[at] * (1 - part)[:, None] + lattice[at + 1] * part[:, None]
    return rows[:, at] * (1 - part) + rows[:, at + 1] * part


def write_images(folder, size, seed):
    """Colours of stone and moss, with grain: as well compressible as photographs."""
    random_ = np.random.default_rng((seed, 2))
    coarse = octave(random_, size, size // 16) + octave(random_, size, 64) / 2
    fine = octave(random_, size, 8) / 2 + octave(random_, size, 2) / 4
    for i in range(IMAGES):
        light = np.roll(coarse, (i * size // 5, i * size // 7), (0, 1)) + np.roll(fine, i * size // 3, 0)
        moss = np.roll(coarse, (i * size // 9, i * size // 4), (0, 1))
        channels = [light * (55 + 2 * i) + 20, light * 60 + 16 * moss + 15, light * (70 - 2 * i) + 8 * moss]
        PIL.Image.fromarray(np.stack(channels, axis=-1).astype(np.uint8)).save(folder / f"image{i}.jpg", quality=92)


def write_model(folder, cells, size, seed):
    write_images(folder, size, seed)
    with open(folder / "terrain.mtl", "w", encoding="utf-8") as file:
        file.writelines(f"newmtl m{i}\nmap_Kd image{i}.jpg\n" for i in range(IMAGES))
    with open(folder / "part.obj", "w", encoding="utf-8") as file:
        file.write("mtllib terrain.mtl\n")
        for first in range(0, cells + 1, 64):
            rows = np.arange(first, min(first + 64, cells + 1))
            z = heights(rows, cells, seed)
            places = np.stack([np.broadcast_to(np.arange(cells + 1), z.shape), np.broadcast_to(rows[:, None], z.shape), z], axis=-1)
            np.savetxt(file, places.reshape(-1, 3), "v %d %d %.4f")
        t = np.stack(np.meshgrid(np.arange(CHART + 1), np.arange(CHART + 1)), axis=-1).reshape(-1, 2) / CHART
        j, i = (index.ravel() for index in np.meshgrid(np.arange(CHART), np.arange(CHART), indexing="ij"))
        along = math.ceil(math.sqrt((cells // CHART) ** 2 / IMAGES))  # charts of an image, along each side
        charts = 0
        for first_j in range(0, cells, CHART):
            for first_i in range(0, cells, CHART):
                place = charts // IMAGES
                low = (np.array([place % along, place // along]) + GAP / 2 / size * along) / along
                np.savetxt(file, low + t * (1 / along - GAP / size), "vt %.6f %.6f")
                file.write(f"usemtl m{charts % IMAGES}\n")
                v, w = (first_j + j) * (cells + 1) + first_i + i + 1, charts * (CHART + 1) ** 2 + j * (CHART + 1) + i + 1
                step, row = cells + 1, CHART + 1
                kept = np.random.default_rng((seed, charts, 1)).random(len(v)) > 0.0005 if charts % 3 == 0 else np.ones(len(v), bool)  # holes
                for corners in (((0, 0), (1, 1), (step + 1, row + 1)), ((0, 0), (step + 1, row + 1), (step, row))):
                    faces = np.stack([column for a, b in corners for column in (v + a, w + b)], axis=1)[kept]
                    np.savetxt(file, faces, "f %d/%d %d/%d %d/%d")
                charts += 1
    (folder / "part.obj").rename(folder / "terrain.obj")


def built(command, folder, name, *arguments):
    start = time.monotonic()
    told = json.loads(subprocess.run([*command, "-o", folder / name, "--json", *arguments], check=True, capture_output=True, text=True).stdout)
    print(f"{name}: {told['triangles']} triangles, {time.monotonic() - start:.1f} s, peak {told['peak_bytes'] / 1e6:.0f} MB, "
          f"scratch files {told['scratch_bytes'] / 1e6:.0f} MB, {told.get('file_bytes', told.get('bytes')) / 1e6:.0f} MB written", flush=True)
    return time.monotonic() - start


def require_same(folder, *names):
    for other in names[1:]:
        if subprocess.run(["cmp", folder / names[0], folder / other], check=False).returncode != 0:
            raise SystemExit(f"check_hlod_kills.py: {other} has other bytes")


def kill_again_and_again(command, folder, seconds, wanted, seed):
    """At random moments of so many seconds. Builds that end sooner do not count: the next begins anew."""
    target, moments, kills, start = folder / "killed.ohlod", random.Random(seed), 0, time.monotonic()
    while kills < wanted:
        target.unlink(missing_ok=True)
        with subprocess.Popen([*command, "-o", target, "--resume"], stdout=subprocess.DEVNULL) as process:
            try:
                process.wait(moments.uniform(0, seconds))
            except subprocess.TimeoutExpired:
                process.kill()
                kills += 1
        kept = sum(file.stat().st_size for file in folder.glob("*.journal"))
        print(f"kill {kills}: after {time.monotonic() - start:.0f} s in all, journals have {kept / 1e6:.0f} MB", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("occlod", type=pathlib.Path)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--cells", type=int, default=3200)
    parser.add_argument("--texels", type=int, default=8192)
    parser.add_argument("--memory", default="1G")
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    model = given.folder / "terrain.obj"
    if not model.exists():
        write_model(given.folder, given.cells, given.texels, given.seed)
    occlod = given.occlod.resolve()
    command = [occlod, "hlod", "build", model, "--memory", given.memory, "--grouping", "nested", "--borders", "free", "--error-bound", "measured"]
    built(command, given.folder, "one.ohlod", "--threads", "1")
    seconds = built(command, given.folder, "all.ohlod")
    kill_again_and_again(command, given.folder, seconds, given.kills, given.seed)
    built(command, given.folder, "killed.ohlod", "--resume")
    require_same(given.folder, "one.ohlod", "all.ohlod", "killed.ohlod")
    command = [occlod, "tiles", given.folder / "all.ohlod", "--memory", given.memory, "--replace"]
    built(command, given.folder, "one.3tz", "--threads", "1")
    built(command, given.folder, "all.3tz")
    require_same(given.folder, "one.3tz", "all.3tz")
    print("the same bytes")


if __name__ == "__main__":
    main()
