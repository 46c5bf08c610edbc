"""Pickles hierarchies and HLODs as the bytes of their files. What else can be pickled says how itself."""

from __future__ import annotations

import copyreg
import pathlib
import tempfile
from collections.abc import Callable
from typing import Any

from ._occlod import Access, Compression, Hierarchy, Hlod, read_hierarchy_and_report, read_hlod_and_report


def _hierarchy_of(data: bytes) -> Hierarchy:
    with tempfile.TemporaryDirectory(prefix="occlod-") as folder:
        path = pathlib.Path(folder, "pickled.olod")
        path.write_bytes(data)
        return read_hierarchy_and_report(path, access=Access.copied)[0]


def _hlod_of(data: bytes) -> Hlod:
    with tempfile.TemporaryDirectory(prefix="occlod-") as folder:
        path = pathlib.Path(folder, "pickled.ohlod")
        path.write_bytes(data)
        return read_hlod_and_report(path, access=Access.copied)[0]


def _reduce_by(read: Callable[[bytes], Any]) -> Callable[[Hierarchy | Hlod], tuple[Any, ...]]:
    def reduce(thing: Hierarchy | Hlod) -> tuple[Any, ...]:
        with tempfile.TemporaryDirectory(prefix="occlod-") as folder:
            path = pathlib.Path(folder, "pickled")
            thing.write(path, compression=Compression.none)
            return read, (path.read_bytes(),)

    return reduce


copyreg.pickle(Hierarchy, _reduce_by(_hierarchy_of))
copyreg.pickle(Hlod, _reduce_by(_hlod_of))
