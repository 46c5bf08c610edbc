#!/usr/bin/env python3
"""walk_cells.py [FOLDER]: builds the view cells of a street, packs them with their geometry, and walks through them without
the city. Prints what each crossing reads, and writes walk_cells.png into FOLDER: left the last frame, right all that is drawn
for its cell, from above."""
import pathlib
import sys
import tempfile

import numpy
import occlod


def build(path: pathlib.Path, eyes: occlod.EyeModel) -> None:
    """Cells of 4 m along 24 m of a street."""
    city = occlod.build_hierarchy(occlod.generate("city", blocks=8, facade_cells=4))
    options = occlod.CellTreeOptions([occlod.CellBox((232, 268, 1), (256, 272, 2.5))], cell=occlod.CellOptions(eyes=eyes),
                                     root_cell=4, smallest_cell=4)
    cells = path.with_suffix(".tmp")
    occlod.CellBuild(city, options).write(cells)
    occlod.VlodFile(cells, city).pack(path)


def main(folder: pathlib.Path) -> None:
    image = {"up": (0, 0, 1), "fov_y_deg": 60, "width": 480, "height": 400, "near": 0.2, "far": 1500}
    keys = [occlod.Camera(eye=(x, 270, 1.7), target=(x + 240, 270, 12), **image) for x in (233, 255)]
    with tempfile.TemporaryDirectory() as work:
        packed = pathlib.Path(work, "street.vlod")
        build(packed, occlod.eye_model(keys[0]))
        walker = occlod.CellWalker(packed, memory=32 << 20, loaders=0)  # nothing is drawn late in an example
        for number, camera in enumerate(occlod.CameraPath(keys, frames=121)):
            frame = walker.step(camera.eye, 1 / 60)
            if frame.crossed:
                print(f"frame {number}: cell {frame.cell}, {frame.drawn_triangles} triangles of {len(frame.positions())} vertices, "
                      f"{frame.error_px:.2f} px at most, {frame.resident_bytes} bytes in memory")
            walker.load()
    objects = frame.draw_objects()  # the file is gone, the frame is not
    items = occlod.draw_items(objects, camera)
    above = occlod.Camera(eye=(255, 270, 200), target=(256, 270, 0), **(image | {"up": (0, 1, 0)}))
    images = [occlod.shade(items, objects, camera), occlod.picture(frame, above, wire=False)]
    occlod.write_png(folder / "walk_cells.png", numpy.ascontiguousarray(numpy.hstack(images)))


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "."))
