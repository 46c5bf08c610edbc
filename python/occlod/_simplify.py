"""A mesh of any package reduced in one call."""

from __future__ import annotations

import dataclasses
import math
import operator
import os
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypedDict, TypeVar, overload

import numpy
import numpy.typing

from ._errors import Error
from ._occlod import Mesh, read_mesh_and_report, simplify_to_distance, simplify_to_triangles
from ._open3d import open3d_like, open3d_tensors_like, soup_of_open3d, soup_of_open3d_tensors
from ._pyvista import pyvista_like, soup_of_pyvista
from ._soup import coordinates_of, is_of, type_name, warn_lost
from ._trimesh import soup_of_trimesh, trimesh_like

if TYPE_CHECKING:
    import pyvista
    import trimesh
    from typing_extensions import Unpack

Progress = Callable[[float], object]

_Trimesh = TypeVar("_Trimesh", bound="trimesh.Trimesh | trimesh.Scene")


@dataclasses.dataclass(frozen=True)
class _Goal:
    """What simplify() is asked for: one of the first three is given."""

    triangles: int | None
    ratio: float | None
    error: float | None
    refit: bool
    threads: int
    progress: Progress | None

    def reduce(self, mesh: Mesh) -> Mesh:
        cleaned, _ = mesh.clean()
        return self.reduce_cleaned(cleaned)

    def reduce_cleaned(self, mesh: Mesh) -> Mesh:
        refit, threads, progress = self.refit, self.threads, self.progress
        if self.error is not None:
            return simplify_to_distance(mesh, self.error, refit=refit, threads=threads, progress=progress)
        most = self.most_of(mesh.triangle_count)
        return simplify_to_triangles(mesh, most, refit=refit, threads=threads, progress=progress)

    def most_of(self, triangles: int) -> int:
        if self.triangles is not None:
            return self.triangles
        return max(4, int((self.ratio or 0.0) * triangles))

    def part(self, first: float, last: float, **changes: Any) -> _Goal:
        """The same for a piece of work between two shares of the whole."""
        whole = self.progress
        if whole is None:
            return dataclasses.replace(self, **changes)
        return dataclasses.replace(
            self, progress=lambda done: whole(last if done == 1 else first + (last - first) * done), **changes
        )


def _number(name: str, value: object, wanted: str, accepts: Callable[[float], bool]) -> float | None:
    if value is None:
        return None
    try:
        number = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        raise TypeError(f"simplify: {name}: is {type_name(value)}; give {wanted}") from None
    if not accepts(number):
        raise ValueError(f"simplify: {name}: is {value}; give {wanted}")
    return number


def _count(triangles: object) -> int | None:
    if triangles is None:
        return None
    try:
        count = operator.index(triangles)  # type: ignore[arg-type]
    except TypeError:
        raise TypeError(f"simplify: triangles: is {type_name(triangles)}; give a whole number above 0") from None
    if count < 1:
        raise ValueError(f"simplify: triangles: is {count}; give a whole number above 0")
    return count


def _of_file(path: str | bytes | os.PathLike[str], goal: _Goal, lost: list[str]) -> Mesh:
    mesh, report = read_mesh_and_report(os.fsdecode(path), goal.part(0.0, 0.2).progress)
    lost += [f"{name} ({count})" for name, count in report.left_out.items()]
    return goal.part(0.2, 1.0).reduce_cleaned(mesh)


def _of_arrays(pair: tuple[Any, Any], goal: _Goal) -> tuple[Any, Any]:
    positions, triangles = (numpy.asarray(array) for array in pair)
    mesh = goal.reduce(Mesh(positions, triangles))
    kind = positions.dtype if positions.dtype.kind == "f" else numpy.dtype(numpy.float64)
    return coordinates_of(mesh).astype(kind), mesh.triangles.astype(triangles.dtype)


def _of_trimesh(mesh: Any, goal: _Goal, lost: list[str]) -> Any:
    soup = soup_of_trimesh(mesh)
    lost += soup.lost
    return trimesh_like(mesh, soup, goal.reduce(soup.mesh()))


def _largest_scale(scene: Any, name: str) -> float:
    """Of the instances of a geometry."""
    places = [scene.graph.get(node) for node in scene.graph.nodes_geometry]
    scales = [float(numpy.linalg.norm(matrix[:3, :3], ord=2)) for matrix, geometry in places if geometry == name]
    return max(scales, default=1.0) or 1.0


def _of_scene(scene: Any, goal: _Goal, lost: list[str]) -> Any:
    """Each geometry once, however many instances it has. Of `triangles` it gets 4, and its share of the rest."""
    meshes = {name: part for name, part in scene.geometry.items() if is_of(part, "trimesh", "Trimesh")}
    sizes = {name: len(mesh.faces) for name, mesh in meshes.items() if len(mesh.faces) > 0}
    if not sizes:
        raise Error("scene", "", "has no triangles", "give one with meshes")
    whole, least = sum(sizes.values()), 4 * len(sizes)
    if goal.triangles is not None and goal.triangles < least:
        raise ValueError(
            f"simplify: triangles: is {goal.triangles}; give at least {least}, 4 for each mesh of the scene"
        )
    result, done = scene.copy(), 0
    for name, size in sizes.items():
        changes: dict[str, Any] = {}
        if goal.triangles is not None:
            changes["triangles"] = 4 + (goal.triangles - least) * size // whole
        if goal.error is not None:
            changes["error"] = goal.error / _largest_scale(scene, name)
        part = goal.part(done / whole, (done + size) / whole, **changes)
        told: list[str] = []
        try:
            result.geometry[name] = _of_trimesh(meshes[name], part, told)
        except Error as error:
            raise Error(name, error.place, error.problem, error.remedy) from None
        lost += [f'{text} of "{name}"' for text in told]
        done += size
    return result


def _of_pyvista(dataset: Any, goal: _Goal, lost: list[str]) -> Any:
    soup, surface = soup_of_pyvista(dataset)
    lost += soup.lost
    return pyvista_like(surface, soup, goal.reduce(soup.mesh()))


def _of_open3d(mesh: Any, goal: _Goal, lost: list[str]) -> Any:
    if not hasattr(mesh, "vertex"):
        soup = soup_of_open3d(mesh)
        return open3d_like(mesh, soup, goal.reduce(soup.mesh()))
    soup = soup_of_open3d_tensors(mesh.cpu())
    lost += soup.lost
    return open3d_tensors_like(mesh, soup, goal.reduce(soup.mesh()))


def _dispatch(x: Any, goal: _Goal, lost: list[str]) -> Any:
    if isinstance(x, (str, bytes, os.PathLike)):
        return _of_file(x, goal, lost)
    if isinstance(x, Mesh):
        return goal.reduce(x)
    if isinstance(x, tuple) and len(x) == 2:
        return _of_arrays(x, goal)
    if is_of(x, "trimesh", "Trimesh"):
        return _of_trimesh(x, goal, lost)
    if is_of(x, "trimesh", "Scene"):
        return _of_scene(x, goal, lost)
    if is_of(x, "open3d", "TriangleMesh"):
        return _of_open3d(x, goal, lost)
    if hasattr(x, "extract_surface"):
        return _of_pyvista(x, goal, lost)
    raise TypeError(
        f"simplify: {type_name(x)} is no mesh; give a path, an occlod.Mesh, a pair (positions, triangles) of arrays, "
        "or a mesh of trimesh, PyVista or Open3D"
    )


class _Options(TypedDict, total=False):
    """What simplify() takes besides the mesh, for type checkers."""

    triangles: int | None
    ratio: float | None
    error: float | None
    refit: bool
    threads: int
    progress: Progress | None


@overload
def simplify(x: str | bytes | os.PathLike[str] | Mesh, **options: Unpack[_Options]) -> Mesh: ...
@overload
def simplify(
    x: tuple[numpy.typing.ArrayLike, numpy.typing.ArrayLike], **options: Unpack[_Options]
) -> tuple[numpy.typing.NDArray[Any], numpy.typing.NDArray[Any]]: ...
@overload
def simplify(x: _Trimesh, **options: Unpack[_Options]) -> _Trimesh: ...
@overload
def simplify(x: pyvista.DataSet, **options: Unpack[_Options]) -> pyvista.PolyData: ...
@overload
def simplify(x: Any, **options: Unpack[_Options]) -> Any: ...
def simplify(
    x: Any,
    *,
    triangles: int | None = None,
    ratio: float | None = None,
    error: float | None = None,
    refit: bool = True,
    threads: int = 0,
    progress: Progress | None = None,
) -> Any:
    """The mesh with fewer triangles, the same for every view: at most `triangles`, at most the share `ratio` in (0, 1] of
    them, though 4, or as few as leave no point of either surface farther than `error` (the input's unit) from the other, as
    measured.

    `x` is a path, which gives a Mesh; or a Mesh, a pair (positions, triangles) of arrays, a mesh or scene of trimesh, a
    dataset of PyVista with a surface, or a mesh of Open3D of either kind, which give what they are, but datasets PolyData.
    Vertices at exactly the same position are welded first. Texture coordinates, normals, colours (with 8 bits) and materials
    are kept; other data of points are those of the nearest vertex of the input; a warning names what is left out. Of a scene
    each mesh is reduced once, to 4 triangles and its share of the others; `error` counts where its largest instance stands.

    With `refit` vertices move to where the surface fits best. `threads`: 0 for one per core; the result does not depend on
    them. `progress` is called with the share done; what it raises, and Ctrl-C, end the call. TypeError for what is no mesh,
    ValueError for a number out of range, Error for a bad file or mesh. O(n log n); measuring for `error` takes up to some
    hundred times as long.
    """
    if sum(goal is not None for goal in (triangles, ratio, error)) != 1:
        raise TypeError("simplify: give one of triangles, ratio and error")
    goal = _Goal(
        _count(triangles),
        _number("ratio", ratio, "a number above 0 and at most 1", lambda r: 0 < r <= 1),
        _number("error", error, "a length above 0", lambda e: 0 < e < math.inf),
        refit,
        threads,
        progress,
    )
    lost: list[str] = []
    result = _dispatch(x, goal, lost)
    warn_lost("simplify", lost, stacklevel=2)
    return result
