#!/usr/bin/env python3
# %% [markdown]
"""
# Refine a mesh for one view

A planet near its ground, 4,000 triangles with and without occlusion. Writes refine.png: left without, right with it.
"""

# %%
import numpy
import occlod

hierarchy = occlod.build_hierarchy(occlod.generate("rough-planet", level=8))  # 524,288 triangles
hierarchy

# %%
camera = occlod.Camera(eye=(0, 1.12, 0), target=(0, 0.98, -0.4), fov_y_deg=60, width=480, height=400, near=0.005)
refiner = occlod.Refiner(hierarchy)
images = []
for name in ("none", "software"):
    refined = refiner.refine(camera, 4_000, occlod.Visibility(name))
    objects = refined.draw_objects()
    items = occlod.draw_items(objects, camera)
    images.append(occlod.shade(items, objects, camera))
    print(f"{name}: {items.visible_triangles()} of {refined.stats.triangles} triangles are visible")

# %%
image = numpy.hstack(images)
occlod.write_png("refine.png", image)
occlod.show(image)
