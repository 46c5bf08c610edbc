#!/usr/bin/env python3
"""textured_cut.py [FOLDER]: simplifies a mesh with a texture and two materials; its seam and the borders between the materials
stay where they are. Writes textured_cut.glb, which holds the texture, and textured_cut.png into FOLDER: left the input, right
the cut. Pictures show colours, not textures, so the texture is sampled at the vertices for them."""
import pathlib
import sys

import numpy
import occlod


def textured_planet() -> occlod.Mesh:
    """With texture coordinates by longitude and latitude, and seas of another material. Every corner of a triangle gets a vertex
    of its own: clean() joins those that are equal."""
    planet = occlod.generate("rough-planet", level=7)
    places = planet.positions[planet.triangles]  # (triangles, corners, 3)
    heights = numpy.linalg.norm(places, axis=2)
    u = numpy.arctan2(places[..., 0], places[..., 2]) / (2 * numpy.pi)
    u += numpy.round(u[:, :1] - u)  # triangles across the seam are not torn
    v = numpy.arcsin(places[..., 1] / heights) / numpy.pi + 0.5
    land, sea = occlod.Material("land", texture=0), occlod.Material("sea", base_color=(0.02, 0.1, 0.4, 1))
    mesh = occlod.Mesh(
        places.reshape(-1, 3), numpy.arange(heights.size).reshape(-1, 3), texture_coordinates=numpy.stack([u, v], axis=2).reshape(-1, 2),
        triangle_materials=(heights.mean(axis=1) < 0.985).astype(int), materials=[land, sea], textures=[occlod.Texture("stripes.png")],
    )
    return mesh.clean()[0]


def colored(mesh: occlod.Mesh, image: numpy.ndarray) -> occlod.Mesh:
    """What the pictures show: each triangle by itself, in the colour of its material or of the texture at its corners."""
    corners = mesh.wedge_triangles.ravel()
    u, v = mesh.texture_coordinates[corners].T
    size = len(image)
    colors = image[((1 - v) * (size - 1)).astype(int) % size, (u * size).astype(int) % size]
    colors[numpy.repeat(mesh.triangle_materials, 3) == 1] = (40, 90, 170, 255)
    return occlod.Mesh(mesh.positions[corners], numpy.arange(len(corners)).reshape(-1, 3), colors=colors)


def main(folder: pathlib.Path) -> None:
    across = numpy.linspace(0, 1, 256)
    stripes = 110 + 100 * numpy.sign(numpy.sin(24 * numpy.pi * across))  # with a gradient from top to bottom
    image = numpy.full((256, 256, 4), 255, numpy.uint8)
    image[..., 0], image[..., 1], image[..., 2] = stripes, 220 * across[:, None], 140
    occlod.write_png(folder / "stripes.png", image)

    planet = textured_planet()
    cut = occlod.build_hierarchy(planet).cut(triangles=12_000)
    cut.mesh().write(folder / "textured_cut.glb")
    print(f"{cut.mesh().triangle_count} of {planet.triangle_count} triangles, no farther than {cut.guaranteed_error:.3f} from them")
    camera = occlod.Camera(eye=(0, 0.8, -2.8), width=480, height=400)
    pictures = [occlod.picture(colored(mesh, image), camera, wire=False) for mesh in (planet, cut.mesh())]
    occlod.write_png(folder / "textured_cut.png", numpy.ascontiguousarray(numpy.hstack(pictures)))


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "."))
