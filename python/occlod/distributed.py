"""View cells and HLODs built on many machines, by Dask.distributed (pip install occlod[cluster]).

    import distributed
    import occlod.distributed

    with distributed.Client("tcp://scheduler:8786") as client:
        occlod.distributed.build_cells("city.json", options, "city.vlod", client=client)
        occlod.distributed.build_hlod("city.json", "city.ohlod", client=client)

View cells: root cells are divided in shards, each of which becomes one .vpart file in a folder that all machines see. Nothing of size
passes the scheduler. Parts that are there and whole are not built again, so a build that was ended goes on when it is
called again, and what was built twice has the same bytes. A shard whose worker dies is tried elsewhere; one that kills
several is halved, until the root cells that do are known.

HLODs: who calls reads the input, groups the triangles of each level, and hands the groups to workers as files, which need
nothing else. It joins their results in order, and keeps what is joined in a journal.
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
from typing import Any

import distributed

from ._errors import Error
from ._occlod import CellBuild, CellTreeOptions, Scene, build_hlod_file, merge_cells, simplify_part

# A run of root cells: the first, and how many.
Range = tuple[int, int]

SHARDS_A_CORE = 16  # as many unless a number is given, so that the last of them take little time
AHEAD = 4  # shards or tasks for each core that are handed out before others are done
COUNT_AFTER_S = 1.0  # cores are counted again, since workers come and go
PATIENCE_S = 60.0  # until a file that a worker wrote is seen here


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


@dataclass(frozen=True)
class HlodReport:
    """What build_hlod() did."""

    tasks: int  # simplified by workers this time
    worker_seconds: float  # of the tasks
    seconds: float  # in all


def _simplify(task: str, threads: int) -> float:
    """On a worker."""
    start = time.monotonic()
    simplify_part(task, threads=threads)
    return time.monotonic() - start


class _Simplifiers:
    """Has tasks simplified by workers, a few for each core at once."""

    def __init__(self, client: distributed.Client, threads: int, retries: int) -> None:
        self.client, self.threads, self.retries = client, threads, retries
        self.running: dict[distributed.Future, pathlib.Path] = {}
        self.done = distributed.as_completed()
        self.most, self.counted_s = 0, -COUNT_AFTER_S  # tasks at once, and when the cores were counted for it
        self.tasks, self.worker_seconds = 0, 0.0

    def start(self, task: pathlib.Path) -> None:
        """Returns when few enough are running."""
        future = self.client.submit(_simplify, str(task), self.threads, retries=self.retries, pure=False)
        self.running[future] = task
        self.done.add(future)
        if time.monotonic() > self.counted_s + COUNT_AFTER_S:
            self.most, self.counted_s = AHEAD * max(1, sum(self.client.nthreads().values())), time.monotonic()
        while len(self.running) > self.most:
            self.take()

    def finish(self, task: pathlib.Path) -> None:
        """Returns when a task is done and its result is seen here, or long should have been."""
        while task in self.running.values():
            self.take()
        result, start = task.with_suffix(".nodes"), time.monotonic()
        while not result.exists() and time.monotonic() - start < PATIENCE_S:
            time.sleep(0.05)

    def take(self) -> None:
        """Waits for one of the tasks."""
        future = next(self.done)
        task = self.running.pop(future)
        try:
            self.worker_seconds += future.result()  # waits where it is lost with its worker: then the task is run again
        except distributed.KilledWorker as error:
            raise Error(str(task), "", "kills the workers that simplify it", "see their logs; what is done is kept") from error
        self.tasks += 1

    def cancel(self) -> None:
        self.client.cancel(list(self.running))


def build_hlod(
    scene: str | os.PathLike[str],
    path: str | os.PathLike[str],
    *,
    client: distributed.Client,
    parts: str | os.PathLike[str] | None = None,
    task_threads: int = 1,
    retries: int = 3,
    **options: Any,
) -> HlodReport:
    """Builds the .ohlod file of a scene with the workers of `client`: the bytes that `occlod hlod build` gives.

    `scene`: a scene or mesh file, which only this machine reads. `parts`: a folder that all machines see under one name;
    `path` with ".parts" unless it is given. What is done is kept there and in `path` with ".journal" until the file is
    written: the same call goes on where one was ended, and `occlod hlod build --resume` from the journal. `task_threads`: of each task; 0: one for each core of its machine. `retries`: of a task that fails with its
    worker alive; how many workers it may kill is the scheduler's setting `distributed.scheduler.allowed-failures`.

    `options`: `node_triangles`, `grouping`, `borders`, `within`, `error_bound`, `quantise_bits`, `threads` (of this machine)
    and `progress` of occlod.build_hlod(), `compression` of Hlod.write(), and `memory`: bytes of main memory to keep to here,
    for inputs that are larger.

    Error as occlod.build_hlod() raises, for a task that kills its workers, and for files that are not seen by all.
    """
    begin = time.monotonic()
    scene, path = pathlib.Path(scene).resolve(), pathlib.Path(path).resolve()
    folder = (pathlib.Path(parts) if parts is not None else path.with_name(path.name + ".parts")).resolve()
    if path.exists() and scene.exists() and os.path.samefile(path, scene):
        raise Error(str(path), "", "is the scene, which would be overwritten", "name another file")
    folder.mkdir(parents=True, exist_ok=True)
    journal = path.with_name(path.name + ".journal")
    workers = _Simplifiers(client, task_threads, retries)
    try:
        build_hlod_file(scene, path, parts=folder, journal=journal, start=workers.start, finish=workers.finish, **options)
    finally:
        workers.cancel()
    journal.unlink()
    _remove_parts(folder)
    return HlodReport(workers.tasks, workers.worker_seconds, time.monotonic() - begin)


def _remove_parts(folder: pathlib.Path) -> None:
    """What the build has made, and what killed workers left; and the folder, unless there is more in it."""
    for file in [*folder.glob("level-*.task"), *folder.glob("level-*.nodes"), *folder.glob(".level-*.tmp")]:
        file.unlink(missing_ok=True)
    if not any(folder.iterdir()):
        folder.rmdir()
