#!/usr/bin/env python3
# %% [markdown]
"""
# What to draw for all eyes in a cell

What has to be drawn wherever the eye is in a cell of a street and wherever it looks, with and without what hides. Writes
cells.png: left the street from one eye of the cell, right all that is drawn for the cell, from above.
"""

# %%
import numpy
import occlod

city = occlod.build_hierarchy(occlod.generate("city", blocks=8, facade_cells=4))
(x0, y0, _), (x1, y1, _) = city.box
of_image = {"up": (0, 0, 1), "fov_y_deg": 60, "width": 480, "height": 400, "near": 0.2, "far": 3 * (x1 - x0)}
camera = occlod.Camera(eye=(240, 270, 1.7), target=(480, 270, 12), **of_image)

# %%
cell = occlod.CellBox((238, 268, 1), (242, 272, 2.5))
options = occlod.CellOptions(eyes=occlod.eye_model(camera), tolerance_px=1)
occluders = occlod.CellOccluders(city, max_motion=0.25)  # once for all cells
cut = occlod.CellBuilder(city, occluders, options).build(cell)
without = occlod.CellBuilder(city, options=options).build(cell)
print(f"{cut.drawn_triangles} triangles; {without.drawn_triangles} if nothing were hidden; {cut.error_px:.2f} px at most")

# %%
objects = cut.draw_objects()
items = occlod.draw_items(objects, camera)
middle = (x0 + x1) / 2, (y0 + y1) / 2
above = occlod.Camera(eye=(*middle, 0.95 * (x1 - x0)), target=(*middle, 0), **(of_image | {"up": (0, 1, 0)}))
image = numpy.hstack([occlod.shade(items, objects, camera), occlod.picture(cut, above, wire=False)])
occlod.write_png("cells.png", image)
occlod.show(image)
