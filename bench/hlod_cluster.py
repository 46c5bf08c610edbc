#!/usr/bin/env python3
"""hlod_cluster.py MESH [--rounds N] [--csv FILE]: the HLOD of a scene or mesh by one and by two workers of Dask, in turns, and what that says of larger clusters by a
model. Needs occlod[cluster]."""
import argparse
import csv
import os
import pathlib
import tempfile

import distributed
import occlod
import occlod.distributed


def by_dask(mesh, path, workers):
    with distributed.LocalCluster(n_workers=workers, threads_per_worker=1, processes=True, dashboard_address=":0", silence_logs=50) as cluster:
        with distributed.Client(cluster) as client:
            client.run(occlod.version)  # loads the library
            return occlod.distributed.build_hlod(mesh, path, client=client)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("mesh", type=pathlib.Path)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--csv", type=pathlib.Path)
    given = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory(dir=os.environ.get("TMPDIR")) as name:
        files = [pathlib.Path(name, f"{workers}.ohlod") for workers in (1, 2)]
        for number in range(given.rounds):  # in turns: the machine is not the same all the time
            reports = [by_dask(given.mesh, file, workers) for workers, file in enumerate(files, 1)]
            if files[0].read_bytes() != files[1].read_bytes():
                raise SystemExit("hlod_cluster.py: the files differ")
            rows.append([number + 1, reports[0].tasks, *(r.seconds for r in reports), *(r.worker_seconds for r in reports)])
            print(f"{reports[0].seconds:.2f} s by one worker, {reports[1].seconds:.2f} s by two, {reports[0].worker_seconds:.2f} and "
                  f"{reports[1].worker_seconds:.2f} s of workers in {reports[0].tasks} tasks", flush=True)
    middle = sorted(rows, key=lambda row: row[2] / row[3])[len(rows) // 2]
    _, _, one, two, busy, _ = middle
    print(f"two workers over one {one / two:.2f} times; {len(os.sched_getaffinity(0))} cores; workers have {100 * busy / one:.0f} % of the time of one")
    print("by the model, not measured: the driver's time as it is, that of workers divided by their number")
    for workers in (4, 8, 16, 64):
        print(f"  {workers:3} workers: {one / (one - busy + busy / workers):.1f} times one")
    if given.csv:
        with given.csv.open("w", newline="") as file:
            table = csv.writer(file, lineterminator="\n")
            table.writerow(["run", "tasks", "one_worker_s", "two_workers_s", "busy_one_s", "busy_two_s"])
            table.writerows([*row[:2], *(f"{seconds:.3f}" for seconds in row[2:])] for row in rows)


if __name__ == "__main__":
    main()
