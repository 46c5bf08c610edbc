#!/usr/bin/env python3
"""refine.py [FOLDER]: a planet near its ground, 4,000 triangles with and without occlusion. Writes refine.png into FOLDER:
left without, right with it."""
import pathlib
import sys

import numpy
import occlod

BUDGET = 4_000


def main(folder: pathlib.Path) -> None:
    hierarchy = occlod.build_hierarchy(occlod.generate("rough-planet", level=8))  # 524,288 triangles
    camera = occlod.Camera(eye=(0, 1.12, 0), target=(0, 0.98, -0.4), fov_y_deg=60, width=480, height=400, near=0.005)
    refiner = occlod.Refiner(hierarchy)
    images = []
    for name in ("none", "software"):
        refined = refiner.refine(camera, BUDGET, occlod.Visibility(name))
        objects = refined.draw_objects()
        items = occlod.draw_items(objects, camera)
        images.append(occlod.shade(items, objects, camera))
        print(f"{name}: {items.visible_triangles()} of {refined.stats.triangles} triangles are visible")
    occlod.write_png(folder / "refine.png", numpy.ascontiguousarray(numpy.hstack(images)))


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "."))
