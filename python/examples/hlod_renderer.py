#!/usr/bin/env python3
"""hlod_renderer.py [FOLDER]: an HLOD in a renderer of one's own: selects the nodes for a view, and lists the triangles of their
meshes. Writes hlod_renderer.png into FOLDER, with a colour for each level. occlod.Traverser selects faster, leaves out what is
outside the view or hidden, and tells what it drew in HlodFrame.draws."""
import collections.abc
import pathlib
import sys

import numpy
import occlod


def select(hlod: occlod.Hlod, view: occlod.View, tolerance_px: float) -> collections.abc.Iterator[tuple[int, int, int]]:
    """(node, first triangle, triangles) of all that is to be drawn. Goes through all nodes, parents first, and replaces those
    whose error covers too many pixels by their children. These never have a larger error, so what remains is a whole surface
    without gaps."""
    refined = set()
    for n in range(hlod.node_count):
        if hlod.node(n).screen_error_px(view.camera.eye, view.focal_length_px, view.camera.near) > tolerance_px:
            refined.add(n)  # never on level 0, whose error is 0
            continue
        for parent, first_index, indices in hlod.patches(n).tolist():
            if parent == occlod.NO_ID or parent in refined:
                yield n, first_index // 3, indices // 3


def main(folder: pathlib.Path) -> None:
    city = occlod.build_hlod(occlod.generate("city", blocks=24))
    camera = occlod.Camera(eye=(20, 20, 60), target=(600, 600, 0), up=(0, 0, 1), width=800, height=400, far=4000)
    # A renderer uploads the mesh of a node once, and draws ranges of its indices. Here all go into one mesh.
    positions, colors, triangles, vertices = [], [], [], 0
    for n, first, count in select(city, occlod.View(camera), 2.0):
        mesh, level = city.mesh(n), city.node(n).level  # level 0 is the input
        positions.append(mesh.positions)
        colors.append(numpy.tile((250 - 40 * level, 60 + 190 * (level % 2), 90 + 25 * level, 255), (len(mesh.positions), 1)))
        triangles.append(mesh.triangles[first : first + count].astype(numpy.uint32) + vertices)
        vertices += len(mesh.positions)
    drawn = occlod.Mesh(numpy.concatenate(positions), numpy.concatenate(triangles), colors=numpy.concatenate(colors).astype(numpy.uint8))
    print(f"{drawn.triangle_count} of {city.input_triangle_count} triangles in {len(triangles)} draws")
    occlod.write_png(folder / "hlod_renderer.png", occlod.picture(drawn, camera, wire=False))


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "."))
