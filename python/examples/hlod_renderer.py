#!/usr/bin/env python3
# %% [markdown]
"""
# An HLOD in a renderer of one's own

What to draw in a view, as ranges of the triangles of nodes. Writes hlod_renderer.png, with a colour for each level.
"""

# %%
import numpy
import occlod

city = occlod.build_hlod(occlod.generate("city", blocks=24))
camera = occlod.Camera(eye=(20, 20, 60), target=(600, 600, 0), up=(0, 0, 1), width=800, height=400, far=4000)
selector = occlod.Selector(city)  # remembers from frame to frame what was visible
selection = selector.select(camera, tolerance_px=2)
print(f"{selection.triangles} of {city.input_triangle_count} triangles; {selection.hidden} nodes are hidden")

# %% [markdown]
"""
A renderer uploads the mesh of a node once, and draws ranges of its indices. Here all go into a picture.
"""

# %%
drawn = []
for _, node, first, count in selection.draws.tolist():
    mesh, level = city.mesh(node), city.node(node).level  # level 0 is the input
    colors = numpy.tile(numpy.uint8((250 - 40 * level, 60 + 190 * (level % 2), 90 + 25 * level, 255)), (len(mesh.positions), 1))
    for first_index, indices in selection.ranges[first : first + count] // 3:
        drawn.append(occlod.DrawObject(mesh.positions, mesh.triangles[first_index : first_index + indices], colors))
image = occlod.shade(occlod.draw_items(drawn, camera), drawn, camera, wire=False)
occlod.write_png("hlod_renderer.png", image)
occlod.show(image)
