#!/usr/bin/env python3
# %% [markdown]
"""
# Simplify a mesh and keep values of its vertices

A mesh with fewer triangles, and a value for each input vertex brought over to it. Writes simplify.png: left the input, right
the cut, both coloured by height.
"""

# %%
import numpy
import occlod

mesh = occlod.generate("rough-planet", level=6, seed=3)
hierarchy = occlod.build_hierarchy(mesh)
cut = hierarchy.cut(triangles=2_000)
small = cut.mesh()
print(f"{small.triangle_count} of {mesh.triangle_count} triangles, no farther than {cut.guaranteed_error:.3f} from them")

# %% [markdown]
"""
For each input vertex there is one of the cut that stands for it; each of these gets the mean of what it stands for.
"""

# %%
stands = cut.vertex_map()[hierarchy.find(mesh.positions)]
heights = numpy.linalg.norm(mesh.positions, axis=1)
means = numpy.bincount(stands, heights, small.vertex_count) / numpy.bincount(stands, minlength=small.vertex_count)


# %%
def colored(values: numpy.ndarray) -> numpy.ndarray:
    """From blue to yellow."""
    share = (values - values.min()) / (values.max() - values.min())
    colors = numpy.stack([share, 0.3 + 0.5 * share, 0.8 - 0.6 * share, numpy.ones_like(share)], axis=1)
    return (255 * colors).astype(numpy.uint8)


camera = occlod.Camera(eye=(0, 0.8, 2.8), width=480, height=400)
image = numpy.hstack([
    occlod.picture(occlod.Mesh(one.positions, one.triangles, colors=colored(values)), camera, wire=wire)
    for one, values, wire in ((mesh, heights, False), (small, means, True))
])
occlod.write_png("simplify.png", image)
occlod.show(image)
