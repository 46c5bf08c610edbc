#!/usr/bin/env python3
# %% [markdown]
"""
# A cut that keeps textures and materials

Simplifies a mesh with a texture and two materials; its seam and the borders between the materials stay where they are. Writes
textured_cut.glb, which holds the texture, and textured_cut.png: left the input, right the cut.
"""

# %%
import numpy
import occlod

across = numpy.linspace(0, 1, 256)
stripes = 110 + 100 * numpy.sign(numpy.sin(24 * numpy.pi * across))  # with a gradient from top to bottom
texture = numpy.full((256, 256, 4), 255, numpy.uint8)
texture[..., 0], texture[..., 1], texture[..., 2] = stripes, 220 * across[:, None], 140
occlod.write_png("stripes.png", texture)
occlod.show(texture)


# %%
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
    made = occlod.Mesh(
        places.reshape(-1, 3), numpy.arange(heights.size).reshape(-1, 3), texture_coordinates=numpy.stack([u, v], axis=2).reshape(-1, 2),
        triangle_materials=(heights.mean(axis=1) < 0.985).astype(int), materials=[land, sea], textures=[occlod.Texture("stripes.png")],
    )
    return made.clean()[0]


mesh = textured_planet()
cut = occlod.build_hierarchy(mesh).cut(triangles=12_000)
cut.mesh().write("textured_cut.glb")
print(f"{cut.mesh().triangle_count} of {mesh.triangle_count} triangles, no farther than {cut.guaranteed_error:.3f} from them")

# %% [markdown]
"""
Pictures show colours, not textures, so the texture is sampled at the vertices for them.
"""


# %%
def colored(one: occlod.Mesh) -> occlod.Mesh:
    """What the pictures show: each triangle by itself, in the colour of its material or of the texture at its corners."""
    corners = one.wedge_triangles.ravel()
    u, v = one.texture_coordinates[corners].T
    size = len(texture)
    colors = texture[((1 - v) * (size - 1)).astype(int) % size, (u * size).astype(int) % size]
    colors[numpy.repeat(one.triangle_materials, 3) == 1] = (40, 90, 170, 255)
    return occlod.Mesh(one.positions[corners], numpy.arange(len(corners)).reshape(-1, 3), colors=colors)


camera = occlod.Camera(eye=(0, 0.8, -2.8), width=480, height=400)
image = numpy.hstack([occlod.picture(colored(one), camera, wire=False) for one in (mesh, cut.mesh())])
occlod.write_png("textured_cut.png", image)
occlod.show(image)
