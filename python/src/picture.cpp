// Item buffers, pictures and their distances.
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <filesystem>

#include "arrays.h"
#include "bindings.h"
#include "occlod/compare.h"
#include "occlod/item_buffer.h"
#include "view_like.h"

namespace occlod::python {
namespace {

using namespace nb::literals;

// Arrays of a caller's own, checked once.
PythonDrawObject make_draw_object(const ArrayLike& positions, const ArrayLike& triangles,
                                  const std::optional<ArrayLike>& colors, const std::optional<ArrayLike>& transform) {
  PythonDrawObject object;
  object.owners = {contiguous(positions, "positions", "float32", 3), contiguous(triangles, "triangles", "uint32", 3)};
  const auto points = nb::cast<nb::ndarray<const float, nb::shape<-1, 3>, nb::c_contig>>(object.owners[0]);
  const auto corners = nb::cast<nb::ndarray<const std::uint32_t, nb::shape<-1, 3>, nb::c_contig>>(object.owners[1]);
  object.draw.positions = {reinterpret_cast<const glm::vec3*>(points.data()), points.shape(0)};
  object.draw.triangles = {reinterpret_cast<const Triangle*>(corners.data()), corners.shape(0)};
  if (colors) {
    object.owners.push_back(contiguous(*colors, "colors", "uint8", 4));
    const auto rgba = nb::cast<nb::ndarray<const std::uint8_t, nb::shape<-1, 4>, nb::c_contig>>(object.owners[2]);
    object.draw.colors = {reinterpret_cast<const glm::u8vec4*>(rgba.data()), rgba.shape(0)};
    if (rgba.shape(0) != points.shape(0)) throw nb::type_error("colors: wrong shape; give one for each position");
  }
  if (transform) object.draw.object_to_world = to_matrix(*transform, "transform");
  return object;
}

// What is drawn may have been changed since: every index is looked at each time.
void require_indices(const DrawObject& object) {
  for (const Triangle& t : object.triangles)
    if (std::max({t.x, t.y, t.z}) >= object.positions.size())
      throw Error({"draw object", "triangle",
                   "uses vertex " + std::to_string(std::max({t.x, t.y, t.z})) + " of " +
                       std::to_string(object.positions.size()),
                   "vertices are counted from 0"});
}

using DrawObjects = std::vector<PythonDrawObject>;

std::vector<DrawObject> parts_of(const DrawObjects& objects) {
  std::vector<DrawObject> parts;
  for (const PythonDrawObject& object : objects) parts.push_back(object.draw);
  return parts;
}

ItemBuffer draw(const DrawObjects& objects, const ViewLike& view) {
  const std::vector<DrawObject> parts = parts_of(objects);
  const View seen = view.get();
  const ReleasedGil release;
  for (const DrawObject& part : parts) require_indices(part);
  ItemBuffer items;
  draw_items(items, parts, seen);
  return items;
}

void require_same_objects(const ItemBuffer& items, const std::vector<DrawObject>& parts) {
  std::size_t triangles = 0;
  for (const DrawObject& part : parts) triangles += part.triangles.size();
  for (const std::uint32_t item : items.items)
    if (item != no_item && item >= triangles)
      throw Error({"item buffer", "", "was drawn of other objects", "give the objects that draw_items() was given"});
}

void require_size(const DepthBuffer& depth, const View& view) {
  if (depth.width != view.width() || depth.height != view.height())
    throw Error({"item buffer", "",
                 "is of " + std::to_string(depth.width) + "x" + std::to_string(depth.height) + " pixels",
                 "give one that was drawn for this view"});
}

nb::object to_array(Image image) {
  auto kept = std::make_unique<std::vector<glm::u8vec4>>(std::move(image.pixels));
  const std::size_t shape[3] = {static_cast<std::size_t>(image.height), static_cast<std::size_t>(image.width), 4};
  auto* const data = reinterpret_cast<std::uint8_t*>(kept->data());
  return nb::cast(
      nb::ndarray<nb::numpy, std::uint8_t, nb::shape<-1, -1, 4>>(data, 3, shape, owner_of(std::move(kept))));
}

using PixelsIn = nb::ndarray<const std::uint8_t, nb::shape<-1, -1, 4>, nb::c_contig, nb::device::cpu>;

Image to_image(const PixelsIn& pixels) {
  Image image{static_cast<int>(pixels.shape(1)), static_cast<int>(pixels.shape(0)), {}};
  const auto* const first = reinterpret_cast<const glm::u8vec4*>(pixels.data());
  image.pixels.assign(first, first + pixels.shape(0) * pixels.shape(1));
  return image;
}

constexpr const char* image_sig = "-> numpy.typing.NDArray[numpy.uint8]";

template <typename T>
auto rows_of_pixels(const std::vector<T>& values, const DepthBuffer& depth, nb::handle owner) {
  const std::size_t shape[2] = {static_cast<std::size_t>(depth.height), static_cast<std::size_t>(depth.width)};
  return ImageArray<const T>(values.data(), 2, shape, owner);
}

void bind_items(nb::module_& m) {
  nb::class_<PythonDrawObject>(m, "DrawObject", "Triangles of one placed object, to be drawn.")
      .def(
          "__init__",
          [](PythonDrawObject* self, const ArrayLike& positions, const ArrayLike& triangles,
             const std::optional<ArrayLike>& colors, const std::optional<ArrayLike>& transform) {
            new (self) PythonDrawObject(make_draw_object(positions, triangles, colors, transform));
          },
          "positions"_a, "triangles"_a, "colors"_a = nb::none(), "transform"_a = nb::none(),
          "positions (n, 3), triangles (m, 3), colors (n, 4) of uint8. float32, uint32 and uint8 arrays in C order "
          "are\n"
          "used without a copy and kept alive.");
  nb::class_<ItemBuffer>(m, "ItemBuffer", "Depth, and which triangle owns each pixel. Read-only views keep it alive.")
      .def_prop_ro(
          "items",
          [](nb::handle self) {
            const ItemBuffer& b = nb::cast<const ItemBuffer&>(self);
            return rows_of_pixels(b.items, b.depth, self);
          },
          "(height, width) uint32, rows from the top: triangle i of object k is (triangles before object k) + i;\n"
          "NO_ID: background.")
      .def_prop_ro(
          "nearness",
          [](nb::handle self) {
            const ItemBuffer& b = nb::cast<const ItemBuffer&>(self);
            return rows_of_pixels(b.depth.nearness, b.depth, self);
          },
          "(height, width) float32: in perspective 1 / distance from the eye plane; 0: nothing there.")
      .def(
          "visible_triangles",
          [](const ItemBuffer& b) {
            std::uint32_t end = 0;
            for (const std::uint32_t item : b.items)
              if (item != no_item) end = std::max(end, item + 1);
            return count_visible_items(b, end);
          },
          "How many triangles own at least one pixel. O(pixels + triangles).");
  m.def("draw_items", &draw, "objects"_a, "view"_a,
        "Draws all objects exactly, one sample at each pixel's centre. Error for an index out of range.\n"
        "O(triangles + pixels covered).");
}

void bind_images(nb::module_& m) {
  const ShadeOptions standard;
  m.def(
      "shade",
      [](const ItemBuffer& items, const DrawObjects& objects, const ViewLike& view, bool wire, glm::vec3 base) {
        const std::vector<DrawObject> parts = parts_of(objects);
        const View seen = view.get();
        Image image;
        {
          const ReleasedGil release;
          require_size(items.depth, seen);
          require_same_objects(items, parts);
          for (const DrawObject& part : parts) require_indices(part);
          image = shade(items, parts, seen, {wire, base});
        }
        return to_array(std::move(image));
      },
      "items"_a, "objects"_a, "view"_a, nb::kw_only(), "wire"_a = standard.wire, "base"_a = standard.base,
      nb::sig("def shade(items: ItemBuffer, objects: collections.abc.Sequence[DrawObject], view: View | Camera, *, "
              "wire: bool = True, base: collections.abc.Sequence[float] = ...) -> numpy.typing.NDArray[numpy.uint8]"),
      "(height, width, 4) uint8, sRGB and alpha: flat shading, from items that draw_items() drew of the same objects\n"
      "and view. `base`: linear RGB of objects without colours.");
  m.def(
      "birdseye",
      [](const DrawObjects& objects, const ItemBuffer& items, const ViewLike& main_view,
         const std::optional<ViewLike>& view) {
        const std::vector<DrawObject> parts = parts_of(objects);
        const View main = main_view.get();
        Image image;
        {
          require_size(items.depth, main);
          require_same_objects(items, parts);
          for (const DrawObject& part : parts) require_indices(part);
          const View seen = view ? view->get() : View(birdseye_camera(parts, main));
          const ReleasedGil release;
          image = birdseye(parts, items, main, seen);
        }
        return to_array(std::move(image));
      },
      "objects"_a, "items"_a, "main_view"_a, "view"_a = nb::none(),
      nb::sig(
          "def birdseye(objects: collections.abc.Sequence[DrawObject], items: ItemBuffer, main_view: View | Camera, "
          "view: View | Camera | None = None) -> numpy.typing.NDArray[numpy.uint8]"),
      "The same objects seen from above, or from `view`: what owns a pixel of `items` is bright, the rest dark.");
  m.def(
      "write_png",
      [](const std::filesystem::path& path, const PixelsIn& pixels) {
        const Image image = to_image(pixels);
        const ReleasedGil release;
        write_png(path, image);
      },
      "path"_a, "image"_a,
      nb::sig("def write_png(path: str | os.PathLike, image: numpy.typing.NDArray[numpy.uint8]) -> None"),
      "Writes (height, width, 4) uint8. An old file stays as it was when writing fails.");
}

void bind_comparisons(nb::module_& m) {
  nb::class_<PictureDistance>(m, "PictureDistance",
                              "Distances between two pictures, 0 or infinite when they are equal.")
      .def_ro("depth_rms_px", &PictureDistance::depth_rms_px,
              "Over pixels covered by both, in pixels at that depth, each capped at 10.")
      .def_ro("silhouette_mismatch", &PictureDistance::silhouette_mismatch,
              "Pixels covered by only one, percent of those that the reference covers.")
      .def_ro("psnr_y", &PictureDistance::psnr_y, "dB, of luma.")
      .def_ro("psnr_cb", &PictureDistance::psnr_cb)
      .def_ro("psnr_cr", &PictureDistance::psnr_cr);
  nb::class_<Popping>(m, "Popping", "How a change of the mesh alone changes the picture.")
      .def_ro("largest_px", &Popping::largest_px)
      .def_ro("rms_px", &Popping::rms_px)
      .def_ro("silhouette_mismatch", &Popping::silhouette_mismatch);
  m.def(
      "compare_pictures",
      [](const ViewLike& view, const ItemBuffer& items, const PixelsIn& image, const ItemBuffer& reference,
         const PixelsIn& reference_image) {
        const View seen = view.get();
        require_size(items.depth, seen);
        require_size(reference.depth, seen);
        const Image one = to_image(image), other = to_image(reference_image);
        for (const Image* i : {&one, &other})
          if (i->width != seen.width() || i->height != seen.height())
            throw Error({"image", "", "has another size than the view", "shade it for this view"});
        const ReleasedGil release;
        return compare_pictures(seen, items.depth, one, reference.depth, other);
      },
      "view"_a, "items"_a, "image"_a, "reference"_a, "reference_image"_a,
      nb::sig("def compare_pictures(view: View | Camera, items: ItemBuffer, image: numpy.typing.NDArray[numpy.uint8], "
              "reference: ItemBuffer, reference_image: numpy.typing.NDArray[numpy.uint8]) -> PictureDistance"),
      "All were drawn for `view`. PSNR is best between images shaded without wire.");
  m.def(
      "count_unexplained_pixels",
      [](const ViewLike& view, const ItemBuffer& expected, const ItemBuffer& found, double allowed_px) {
        const View seen = view.get();
        require_size(expected.depth, seen);
        require_size(found.depth, seen);
        const ReleasedGil release;
        return count_unexplained_pixels(seen, expected.depth, found.depth, allowed_px);
      },
      "view"_a, "expected"_a, "found"_a, "allowed_px"_a,
      "Pixels of `expected` that `found` cannot explain if both show the same surface to within allowed_px pixels.");
  m.def(
      "measure_popping",
      [](const ViewLike& view, const ItemBuffer& before, const ItemBuffer& after) {
        const View seen = view.get();
        require_size(before.depth, seen);
        require_size(after.depth, seen);
        const ReleasedGil release;
        return measure_popping(seen, before.depth, after.depth);
      },
      "view"_a, "before"_a, "after"_a, "The meshes of two consecutive frames, both drawn for the later one's view.");
}

}  // namespace

void bind_picture(nb::module_& m) {
  bind_items(m);
  bind_images(m);
  bind_comparisons(m);
}

}  // namespace occlod::python
