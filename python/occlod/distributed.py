"""View cells built on many machines, by Dask.distributed (pip install occlod[cluster]).

    import distributed
    import occlod.distributed

    with distributed.Client("tcp://scheduler:8786") as client:
        occlod.distributed.build_cells("city.json", options, "city.vlod", client=client)

Root cells are divided in shards, each of which becomes one .vpart file in a folder that all machines see. Nothing of size
passes the scheduler. Parts that are there and whole are not built again, so a build that was ended goes on when it is
called again, and what was built twice has the same bytes. A shard whose worker dies is tried elsewhere; one that kills
several is halved, until the root cells that do are known.
"""

from __future__ import annotations

import os
import pathlib
import pickle
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import distributed

from ._errors import Error
from ._occlod import CellBuild, CellTreeOptions, Scene, merge_cells

# A run of root cells: the first, and how many.
Range = tuple[int, int]

SHARDS_A_CORE = 16  # as many unless a number is given, so that the last of them take little time
AHEAD = 4  # shards for each core that are handed out before others are done


@dataclass(frozen=True)
class CellsReport:
    """What build_cells() did."""

    shards: int  # parts that the file was merged from
    found: int  # of these, that were there before
    cuts: int  # found by the workers for parts that were not, but for those whose receipts were lost with them
    halved: int  # shards that killed their workers
    worker_seconds: float  # of the tasks, loading not included
    seconds: float  # in all


@dataclass(frozen=True)
class _Task:
    scene: str
    options: CellTreeOptions
    parts: str
    name: str  # of the part
    range: Range
    threads: int


@dataclass(frozen=True)
class _Receipt:
    cuts: int
    seconds: float


_lock = threading.Lock()
_loaded: dict[tuple[str, bytes], CellBuild] = {}


def _build_of(scene: str, options: CellTreeOptions) -> CellBuild:
    """Loaded once for each process, whatever the number of shards."""
    key = (scene, pickle.dumps(options))
    with _lock:
        if key not in _loaded:
            _loaded.clear()
            _loaded[key] = CellBuild(Scene.describe(scene).load(), options)
        return _loaded[key]


def _write_shard(task: _Task) -> _Receipt:
    """On a worker."""
    build = _build_of(task.scene, task.options)
    if build.part_name(task.range) != task.name:
        raise Error(task.scene, "", "is another scene for a worker than for who asked it", "let all machines see the same files")
    start, cuts = time.monotonic(), build.cuts
    part = pathlib.Path(task.parts, task.name)
    if not build.has_part(part, task.range):  # else a worker wrote it, and died with its receipt
        build.write_part(part, task.range, threads=task.threads)
    return _Receipt(build.cuts - cuts, time.monotonic() - start)


def _halves(shard: Range) -> list[Range]:
    first, count = shard
    return [(first, count // 2), (first + count // 2, count - count // 2)]


class _Parts:
    """The files of one build."""

    def __init__(self, build: CellBuild, folder: pathlib.Path) -> None:
        self.build, self.folder = build, folder

    def file(self, shard: Range) -> pathlib.Path:
        return self.folder / self.build.part_name(shard)

    def has(self, shard: Range) -> bool:
        return self.file(shard).exists() and self.build.has_part(self.file(shard), shard)

    def cover(self, shard: Range) -> tuple[list[Range], list[Range]]:
        """Parts that are there, and shards that are missing: of one that was halved before, those of its halves."""
        if self.has(shard):
            return [shard], []
        if shard[1] == 1:
            return [], [shard]
        found: list[Range] = []
        missing: list[Range] = []
        for half in _halves(shard):
            there, not_there = self.cover(half)
            found += there
            missing += not_there
        return (found, missing) if found else ([], [shard])


class _Driver:
    """Hands shards out, a few for each core at once, and takes in what becomes of them."""

    def __init__(self, client: distributed.Client, parts: _Parts, task: Callable[[Range], _Task], retries: int) -> None:
        self.client, self.parts, self.task, self.retries = client, parts, task, retries
        self.running: dict[distributed.Future, Range] = {}
        self.attempts: dict[Range, int] = {}
        self.built: list[Range] = []
        self.suspects: list[Range] = []  # root cells whose workers died, perhaps of what else ran there
        self.bad: list[int] = []
        self.receipts: list[_Receipt] = []
        self.halved = 0

    def run(self, missing: list[Range]) -> Iterator[int]:
        """Yields the number of root cells that have been built whenever there are more."""
        waiting = deque(missing)
        done = distributed.as_completed()
        try:
            while waiting or self.running:
                while waiting and len(self.running) < AHEAD * max(1, sum(self.client.nthreads().values())):
                    done.add(self.submit(waiting.popleft()))
                future = next(done)
                waiting.extend(self.take(future, self.running.pop(future)))
                yield sum(count for _, count in self.built)
                if not waiting and not self.running and self.suspects:  # one at a time
                    waiting.append(self.suspects[0])
        finally:
            self.client.cancel(list(self.running))

    def submit(self, shard: Range) -> distributed.Future:
        self.attempts[shard] = self.attempts.get(shard, 0) + 1
        future = self.client.submit(_write_shard, self.task(shard), retries=self.retries, pure=False)
        self.running[future] = shard
        return future

    def take(self, future: distributed.Future, shard: Range) -> list[Range]:
        """What is to be done after this."""
        error = future.exception()  # waits where a receipt is lost with its worker: then the task is run again
        if isinstance(error, distributed.KilledWorker):
            if shard[1] == 1:
                if shard in self.suspects:  # it was alone this time
                    self.suspects.remove(shard)
                    self.bad.append(shard[0])
                else:
                    self.suspects.append(shard)
                return []
            self.halved += 1
            return _halves(shard)
        if error is not None:
            raise error
        receipt = future.result()
        if not self.parts.has(shard):
            if self.attempts[shard] > self.retries:
                raise Error(str(self.parts.file(shard)), "", "a worker wrote it, but it is not here or not whole", "name a folder that all machines see")
            return [shard]
        if shard in self.suspects:
            self.suspects.remove(shard)
        self.built.append(shard)
        self.receipts.append(receipt)
        return []


def build_cells(
    scene: str | os.PathLike[str],
    options: CellTreeOptions,
    path: str | os.PathLike[str],
    *,
    client: distributed.Client,
    parts: str | os.PathLike[str] | None = None,
    shards: int | None = None,
    threads: int = 1,
    retries: int = 3,
    progress: Callable[[float], object] | None = None,
) -> CellsReport:
    """Builds the .vlod file of a scene on the workers of `client`: the bytes that CellBuild.write() gives.

    `scene`: a scene file, a mesh or an .olod file under a name that all machines know. `parts`: a folder that they all see;
    `path` with ".parts" unless it is given. It is kept: the same call goes on where one was ended. `shards`: how many; 16
    for each core unless given. `threads`: of each task; 0: one for each core of its machine, for workers that have a machine
    for themselves and run one task at a time. `retries`: of a shard that fails with its worker alive; how many workers it
    may kill is the scheduler's setting `distributed.scheduler.allowed-failures`. `progress` is called with the share of root
    cells that is done.

    Error when a shard fails again and again, and, when all others are done, for root cells that kill their workers.
    """
    start = time.monotonic()
    scene, path = str(pathlib.Path(scene).resolve()), pathlib.Path(path)
    folder = pathlib.Path(parts) if parts is not None else path.with_name(path.name + ".parts")
    folder = folder.resolve()
    if path.exists() and os.path.samefile(path, scene):
        raise Error(str(path), "", "is the scene, which would be overwritten", "name another file")
    build = CellBuild(Scene.describe(scene).load(), options)
    folder.mkdir(parents=True, exist_ok=True)
    files = _Parts(build, folder)
    number = shards or SHARDS_A_CORE * max(1, sum(client.nthreads().values()))
    ranges = [build.shard(i, number) for i in range(number)]
    found: list[Range] = []
    missing: list[Range] = []
    for shard in ranges:
        if shard[1] > 0:
            there, not_there = files.cover(shard)
            found += there
            missing += not_there

    driver = _Driver(client, files, lambda shard: _Task(scene, options, str(folder), build.part_name(shard), shard, threads), retries)
    before = sum(count for _, count in found)
    for done in driver.run(missing):
        if progress is not None:
            progress((before + done) / build.root_cells)
    if driver.bad:
        cells = ", ".join(map(str, sorted(driver.bad)))
        raise Error(str(path), f"root cell {cells}", "kills the workers that build it", "see their logs; all other parts are kept")
    used = found + driver.built
    merge_cells([files.file(shard) for shard in used], path)
    return CellsReport(len(used), len(found), sum(r.cuts for r in driver.receipts), driver.halved, sum(r.seconds for r in driver.receipts), time.monotonic() - start)
