// Measures how far a refined view is from the full meshes.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "occlod/compare.h"
#include "occlod/refiner.h"
#include "occlod/scene.h"

namespace occlod::tool {

// Shades a picture for comparisons, without wires.
[[nodiscard]] Image shade_without_wire(const ItemBuffer& items, std::span<const DrawObject> objects, const View& view,
                                       std::span<const ObjectTexture> textures = {});

// Holds the picture of the full meshes in one view, to compare refinements with.
class FullMeshPicture {
 public:
  // The view must outlive it, and so must the textures: one per object, or none.
  FullMeshPicture(const std::vector<LoadedObject>& objects, const View& view,
                  std::span<const ObjectTexture> textures = {});

  [[nodiscard]] const ItemBuffer& items() const { return items_; }
  [[nodiscard]] const Image& image() const { return image_; }

  // Returns the distance of a drawn refinement of the same objects in the same view.
  [[nodiscard]] PictureDistance distance_to(const ItemBuffer& items, std::span<const DrawObject> refined) const;
  // Returns how far its texture has slipped, see texture_slip_px(), with or without textures; nothing when no object
  // has texture coordinates.
  [[nodiscard]] std::optional<double> texture_slip_px(const ItemBuffer& items,
                                                      std::span<const DrawObject> refined) const;

 private:
  const View& view_;
  std::span<const ObjectTexture> textures_;
  std::vector<ObjectTexture> coordinates_;  // per object
  ItemBuffer items_;
  Image image_;
  TexelBuffer texels_;  // empty when no object has texture coordinates
};

// Counts what occlusion hides wrongly. Reuses its memory from view to view.
class WronglyHidden {
 public:
  explicit WronglyHidden(const std::vector<LoadedObject>& objects);

  // Refines the reference for this view to a tolerance of 1 px without budget and occlusion, and otherwise as `options`
  // say. The view must outlive the counts.
  void set_view(const View& view, const RefineOptions& options);
  [[nodiscard]] const ItemBuffer& items() const { return without_; }
  [[nodiscard]] std::span<const DrawObject> drawn() const { return drawn_; }

  // Refines in the same way with `visibility`, and returns the number of pixels of the reference that the result cannot
  // explain within the two promised errors: there a visible surface was taken for hidden. `options` may differ from
  // those of set_view() only in what concerns occlusion.
  [[nodiscard]] std::size_t count(const RefineOptions& options, Visibility& visibility);
  // Returns the sum of the two promised errors of the last count(), in pixels.
  [[nodiscard]] double allowed_px() const { return allowed_px_; }

 private:
  const std::vector<LoadedObject>& objects_;
  Refiner reference_refiner_;  // separate, because drawn() shows what it refined
  Refiner refiner_;
  const View* view_ = nullptr;
  std::vector<DrawObject> drawn_;
  ItemBuffer without_;
  ItemBuffer with_;
  double reference_error_px_ = 0.0;
  double allowed_px_ = 0.0;
};

}  // namespace occlod::tool
