#!/usr/bin/env python3
# %% [markdown]
"""
# Walk through view cells

Builds the view cells of a street, packs them with their geometry, and walks through them without the city: what each crossing
reads. Writes street.vlod and walk_cells.png: left the last frame, right all that is drawn for its cell, from above.
"""

# %%
import numpy
import occlod

of_image = {"up": (0, 0, 1), "fov_y_deg": 60, "width": 480, "height": 400, "near": 0.2, "far": 1500}
keys = [occlod.Camera(eye=(x, 270, 1.7), target=(x + 240, 270, 12), **of_image) for x in (233, 255)]

# %% [markdown]
"""
Cells of 4 m along 24 m of the street.
"""

# %%
city = occlod.build_hierarchy(occlod.generate("city", blocks=8, facade_cells=4))
options = occlod.CellTreeOptions([occlod.CellBox((232, 268, 1), (256, 272, 2.5))],
                                 cell=occlod.CellOptions(eyes=occlod.eye_model(keys[0])), root_cell=4, smallest_cell=4)
occlod.CellBuild(city, options).write("street_unpacked.vlod")
occlod.VlodFile("street_unpacked.vlod", city).pack("street.vlod")

# %%
walker = occlod.CellWalker("street.vlod", memory=32 << 20, loaders=0)  # nothing is drawn late in an example
for number, camera in enumerate(occlod.CameraPath(keys, frames=121)):
    frame = walker.step(camera.eye, 1 / 60)
    if frame.crossed:
        print(f"frame {number}: cell {frame.cell}, {frame.drawn_triangles} triangles of {len(frame.positions())} vertices, "
              f"{frame.error_px:.2f} px at most, {frame.resident_bytes} bytes in memory")
    walker.load()

# %%
objects = frame.draw_objects()
items = occlod.draw_items(objects, camera)
above = occlod.Camera(eye=(255, 270, 200), target=(256, 270, 0), **(of_image | {"up": (0, 1, 0)}))
image = numpy.hstack([occlod.shade(items, objects, camera), occlod.picture(frame, above, wire=False)])
occlod.write_png("walk_cells.png", image)
occlod.show(image)
