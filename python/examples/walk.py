#!/usr/bin/env python3
# %% [markdown]
"""
# From frame to frame

Through the streets of a city: what each tenth frame changes. Writes walk.png: left the last frame, right its mesh from above,
bright where the camera sees it.
"""

# %%
import numpy
import occlod

city = occlod.build_hierarchy(occlod.generate("city", blocks=16, facade_cells=4))
(x0, y0, _), (x1, y1, _) = city.box
of_image = {"up": (0, 0, 1), "fov_y_deg": 60, "width": 480, "height": 400, "near": 0.2, "far": 3 * (x1 - x0)}
keys = [occlod.Camera(eye=(x, 481, 1.7), target=(900, 480, 14), **of_image) for x in (125, 325)]
path = occlod.CameraPath(keys, frames=60)

# %% [markdown]
"""
`buffer` is what the index buffer of a renderer would hold: only what has changed is uploaded.
"""

# %%
refiner, visibility = occlod.Refiner(city), occlod.Visibility("software")
buffer = numpy.zeros((0, 3), numpy.uint32)
for number, camera in enumerate(path):
    refined = refiner.update(camera, 8_000, visibility)
    triangles = refined.triangles()
    buffer = numpy.resize(buffer, triangles.shape)
    for first, count in refined.changes():
        buffer[first : first + count] = triangles[first : first + count]
    assert (buffer == triangles).all()
    if number % 10 == 0:
        print(f"frame {number}: {len(triangles)} triangles, {refined.changes()[:, 1].sum()} of them new")

# %%
objects = refined.draw_objects()
items = occlod.draw_items(objects, camera)
middle = (x0 + x1) / 2, (y0 + y1) / 2
above = occlod.Camera(eye=(*middle, 0.95 * (x1 - x0)), target=(*middle, 0), **(of_image | {"up": (0, 1, 0)}))
image = numpy.hstack([occlod.shade(items, objects, camera), occlod.birdseye(objects, items, camera, above)])
occlod.write_png("walk.png", image)
occlod.show(image)
