"""Read by mypy, not run: how the package is meant to be used has types, and misuse does not pass."""
import pathlib

import numpy
import numpy.typing
import occlod


def use() -> None:
    mesh: occlod.Mesh = occlod.read_mesh("a.ply", progress=print)
    materials: tuple[occlod.Material, ...] = mesh.materials
    mesh.materials = (*materials, occlod.Material("red", base_color=(1.0, 0.0, 0.0, 1.0)))
    cutoff: float = materials[0].surface.alpha_cutoff
    coordinates: numpy.typing.NDArray[numpy.float32] | None = mesh.texture_coordinates
    hierarchy = occlod.build_hierarchy(mesh, error_bound=occlod.ErrorBound.measured, progress=lambda done: None)
    box: tuple[tuple[float, float, float], tuple[float, float, float]] = hierarchy.box
    refiner = occlod.Refiner([hierarchy, occlod.Object(hierarchy, numpy.eye(4), two_sided=True)])
    camera = occlod.Camera(eye=(0, 0, 3), width=800)
    refined: occlod.Refinement = refiner.update(camera, 1000, occlod.Visibility("software"))
    options = occlod.RefineOptions(budget=1000, method=occlod.Method.paper)
    refiner.refine(occlod.View(camera), options=options)
    triangles: numpy.typing.NDArray[numpy.uint32] = refined.triangles(0)
    count: int = refined.stats.triangles
    cut: occlod.Cut = hierarchy.cut(error=0.1)
    image: numpy.typing.NDArray[numpy.uint8] = occlod.picture([mesh, refined, cut], camera)
    occlod.write_png("a.png", image)
    objects: list[occlod.Object] = occlod.Scene.read("city.json").load()
    frame: occlod.WalkedFrame = occlod.CellWalker("packed.vlod").step((0.0, 0.0, 2.0), 1 / 60)
    texture_coordinates: numpy.typing.NDArray[numpy.float32] = frame.texture_coordinates()
    wedge_materials: numpy.typing.NDArray[numpy.uint16] = frame.wedge_materials(0)
    surface: tuple[tuple[occlod.Material, ...], tuple[occlod.Texture, ...]] = frame.materials(), frame.textures()
    origin: occlod.TextureOrigin = frame.texture_origin()
    hlod: occlod.Hlod = occlod.build_hlod(mesh, node_triangles=500, journal=pathlib.Path("a.journal"))
    selection: occlod.Selection = occlod.Selector([hlod, occlod.open_hlod("a.ohlod", memory=1 << 26)]).select(camera, budget=1000)
    seen: occlod.Mesh = selection.mesh(1)
    uv: numpy.typing.NDArray[numpy.float32] | None = hlod.mesh(0).texture_coordinates
    view: occlod.View = occlod.view_of(numpy.eye(4), numpy.eye(4), 64, 64, occlod.ClipDepth.zero_to_one)
    print(seen, uv, view)
    tiles: int = occlod.write_tiles("a.ply", "a_tiles", up=occlod.UpAxis.y, origin=(11.5, 48.1, 520)).tiles
    small: occlod.Mesh = occlod.simplify(pathlib.Path("a.ply"), ratio=0.1, progress=print)
    smaller: occlod.Mesh = occlod.simplify(small, error=0.5, refit=False)
    arrays: tuple[numpy.typing.NDArray[numpy.float32], numpy.typing.NDArray[numpy.uint32]]
    arrays = occlod.simplify((mesh.positions, mesh.triangles), triangles=100)
    print(smaller, arrays, occlod.simplify(occlod.to_trimesh(mesh), ratio=0.5).is_watertight)
    again: occlod.Mesh = occlod.from_trimesh(occlod.to_trimesh(mesh))
    print(again, hlod, tiles, texture_coordinates, wedge_materials, surface, origin)
    print(coordinates, box, triangles, count, objects, occlod.to_trimesh(mesh))


def misuse() -> None:
    occlod.simplify("a.ply", share=0.1)  # type: ignore[call-overload]
    occlod.build_hierarchy("a.ply")  # type: ignore[arg-type]
    occlod.Camera(fov=45)  # type: ignore[call-arg]
    occlod.Mesh([[0.0, 0.0, 0.0]], [[0, 0, 0]]).triangle_count = 3  # type: ignore[misc]
