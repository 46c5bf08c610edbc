#!/usr/bin/env python3
"""cells_cluster.py SCENE [--cells N] [--rounds N] [--csv FILE]: view cells of a scene by one process and by one and two workers of Dask, the tasks that its scheduler
hands out in a second, and what these say of larger clusters by the model of docs/guide/view_cells.md#many-machines. Of the first region of the scene so much is taken that
it has about N root cells (128). Needs occlod[cluster]."""
import argparse
import csv
import json
import os
import pathlib
import tempfile
import time

import distributed
import occlod
import occlod.distributed
from cluster_model import modelled


def options_of(scene, root_cells):
    """A row of root cells through the middle of the first region."""
    cells = json.loads(scene.read_text())["cells"]
    low, high = cells["regions"][0]["min"], cells["regions"][0]["max"]
    edge, smallest = cells.get("root_cell", 16.0), cells.get("smallest_cell", 1.0)
    across = max(1, round(root_cells**0.5))
    region = [min(high[i], low[i] + edge * (across if i < 2 else 1)) for i in range(3)]
    return occlod.CellTreeOptions([occlod.CellBox(tuple(low), tuple(region))], root_cell=edge, smallest_cell=smallest, max_triangles=2**62)


def timed(work):
    start = time.monotonic()
    result = work()
    return result, time.monotonic() - start


def load(scene, options):
    """What a process does once, occluders too: they are made with the first cell."""
    with tempfile.TemporaryDirectory() as folder:
        occlod.distributed._build_of(scene, options).write_part(pathlib.Path(folder, "first.vpart"), (0, 1), threads=1)


def by_dask(scene, options, path, workers):
    with distributed.LocalCluster(n_workers=workers, threads_per_worker=1, processes=True, dashboard_address=":0", silence_logs=50) as cluster:
        with distributed.Client(cluster) as client:
            client.run(load, str(scene.resolve()), options)  # the same for any number of cells
            return timed(lambda: occlod.distributed.build_cells(scene, options, path, client=client))


def tasks_a_second():
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=":0", silence_logs=50) as cluster:
        with distributed.Client(cluster) as client:
            client.gather(client.map(abs, range(100)))
            count = 2000
            _, seconds = timed(lambda: client.gather(client.map(lambda x: x + 1, range(count))))
            return count / seconds


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scene", type=pathlib.Path)
    parser.add_argument("--cells", type=int, default=128)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--csv", type=pathlib.Path)
    given = parser.parse_args()
    options = options_of(given.scene, given.cells)
    rows = []
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        objects, load_s = timed(lambda: occlod.Scene.read(given.scene).load())
        build = occlod.CellBuild(objects, options)
        build.write(folder / "first.vlod", threads=1)  # occluders are made once
        for number in range(given.rounds):  # in turns: the machine is not the same all the time
            _, alone = timed(lambda: build.write(folder / "one.vlod", threads=1))
            reports = [by_dask(given.scene, options, folder / f"{number}_{workers}.vlod", workers) for workers in (1, 2)]
            if any((folder / f"{number}_{workers}.vlod").read_bytes() != (folder / "one.vlod").read_bytes() for workers in (1, 2)):
                raise SystemExit("cells_cluster.py: the files differ")
            rows.append([alone, *(seconds for _, seconds in reports)])
    rate = tasks_a_second()
    ratios = sorted(alone / two for alone, _, two in rows)
    alone, one, two = (sorted(row[i] for row in rows)[len(rows) // 2] for i in range(3))
    cell_s = alone / build.root_cells
    print(f"{build.root_cells} cells: {alone:.2f} s in one process, {one:.2f} s by one worker, {two:.2f} s by two; two over one process {ratios[len(ratios) // 2]:.2f} times")
    print(f"{1e3 * cell_s:.0f} ms a cell, {load_s:.1f} s to load, {rate:.0f} tasks/s by the scheduler, {len(os.sched_getaffinity(0))} cores")
    print("by the model, not measured: 5 million cells of this kind")
    for cores in (16, 256, 1000, 10_000):
        seconds, share = modelled(5e6, cell_s, cores, rate, 60 + load_s)
        print(f"  {cores:6} cores: {seconds / 3600:8.2f} h, {100 * share:3.0f} % of them at work")
    if given.csv:
        with given.csv.open("w", newline="") as file:
            table = csv.writer(file, lineterminator="\n")
            table.writerow(["run", "cells", "one_process_s", "one_worker_s", "two_workers_s"])
            table.writerows([i, build.root_cells, *(f"{seconds:.3f}" for seconds in row)] for i, row in enumerate(rows, 1))


if __name__ == "__main__":
    main()
