#!/usr/bin/env python3
# %% [markdown]
"""
# Draw by OpenGL without a window

An HLOD, without what OpenGL's occlusion queries find hidden. Writes the last frame, the darker the farther, to opengl.png.
Needs a package that was built with OpenGL (docs/guide/python.md); runs on a GPU or on Mesa's llvmpipe.
"""

# %%
import numpy
import occlod

device = occlod.Device.gl()
traverser = occlod.Traverser(occlod.build_hlod(occlod.generate("city", blocks=16, facade_cells=4)))

# %%
options = occlod.TraverseOptions(strategy=occlod.Strategy.coh, tolerance_px=1)
of_image = {"up": (0, 0, 1), "fov_y_deg": 60, "width": 480, "height": 400, "near": 0.2, "far": 3000}
keys = [occlod.Camera(eye=(x, 481, 1.7), target=(900, 480, 14), **of_image) for x in (125, 195)]
for number, camera in enumerate(occlod.CameraPath(keys, frames=20)):
    frame = traverser.draw_frame(camera, device, options)
    if number % 5 == 0:
        print(f"frame {number}: {frame.stats.drawn_triangles} triangles, {frame.stats.queries} queries, {frame.stats.hidden_nodes} nodes hidden")

# %%
nearness = device.picture().nearness  # 1 / distance; 0 where nothing is
light = numpy.clip(255 + 32 * numpy.log(numpy.maximum(nearness, 1e-9)), 0, 255).astype(numpy.uint8)
image = numpy.dstack([light, light, light, numpy.full_like(light, 255)])
occlod.write_png("opengl.png", image)
occlod.show(image)
