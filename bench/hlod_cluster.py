#!/usr/bin/env python3
"""hlod_cluster.py MESH --occlod COMMAND [--measured] [--rounds N] [--csv FILE]: the HLOD of a scene or mesh by `COMMAND hlod build` on one and two threads and by one and two
workers of Dask, in turns, with the processor time of who calls and of workers, and what that says of larger clusters by a model. `--measured`: with measured error bounds.
Needs occlod[cluster]. Files must be the same: use a mesh without images."""
import argparse
import csv
import os
import pathlib
import subprocess
import tempfile
import time

import distributed
import occlod
import occlod.distributed


def processor_s(client):
    return sum(client.run(time.process_time).values())


def by_command(command, mesh, path, threads, bound):
    """Seconds."""
    start = time.monotonic()
    subprocess.run([command, "hlod", "build", mesh, "-o", path, "--threads", str(threads), "--error-bound", bound.name], check=True, stdout=subprocess.DEVNULL)
    return time.monotonic() - start


def by_dask(mesh, path, workers, bound):
    """Seconds, and processor seconds of this process and of workers."""
    with distributed.LocalCluster(n_workers=workers, threads_per_worker=1, processes=True, dashboard_address=":0", silence_logs=50) as cluster:
        with distributed.Client(cluster) as client:
            client.run(lambda: __import__("occlod.distributed"))  # loads the library
            here, there = time.process_time(), processor_s(client)
            report = occlod.distributed.build_hlod(mesh, path, client=client, error_bound=bound)
            return report.seconds, time.process_time() - here, processor_s(client) - there


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("mesh", type=pathlib.Path)
    parser.add_argument("--occlod", required=True)
    parser.add_argument("--measured", action="store_true")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--csv", type=pathlib.Path)
    given = parser.parse_args()
    bound = occlod.ErrorBound.measured if given.measured else occlod.ErrorBound.accumulated
    rows = []
    with tempfile.TemporaryDirectory() as name:
        files = [pathlib.Path(name, f"{number}.ohlod") for number in range(4)]
        for number in range(given.rounds):  # in turns: the machine is not the same all the time
            rows.append([number + 1, *(by_command(given.occlod, given.mesh, files[threads - 1], threads, bound) for threads in (1, 2))])
            for workers in (1, 2):
                rows[-1] += by_dask(given.mesh, files[workers + 1], workers, bound)
            if len({file.read_bytes() for file in files}) > 1:
                raise SystemExit("hlod_cluster.py: the files differ")
            print("{1:.2f} s by one thread, {2:.2f} s by two; {3:.2f} s by one worker, {6:.2f} s by two; "
                  "processor {4:.2f} and {7:.2f} s here, {5:.2f} and {8:.2f} s of workers".format(*rows[-1]), flush=True)
    one, two, busy = (sorted(row[i] for row in rows)[len(rows) // 2] for i in (3, 6, 5))
    print(f"two workers over one {one / two:.2f} times; {len(os.sched_getaffinity(0))} cores; workers have {100 * busy / one:.0f} % of the time of one")
    print("by the model, not measured: the time of who calls as it is, that of workers divided by their number")
    for workers in (4, 8, 16, 64):
        print(f"  {workers:3} workers: {one / (one - busy + busy / workers):.1f} times one")
    if given.csv:
        with given.csv.open("w", newline="") as file:
            table = csv.writer(file, lineterminator="\n")
            table.writerow(["run", "one_thread_s", "two_threads_s", "one_worker_s", "here_one_s", "busy_one_s", "two_workers_s", "here_two_s", "busy_two_s"])
            table.writerows([row[0], *(f"{seconds:.3f}" for seconds in row[1:])] for row in rows)


if __name__ == "__main__":
    main()
