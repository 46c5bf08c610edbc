// How far a refined view is from the truth.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "occlod/compare.h"
#include "occlod/refiner.h"
#include "occlod/scene.h"

namespace occlod::tool {

// As pictures are compared.
[[nodiscard]] Image shade_without_wire(const ItemBuffer& items, std::span<const DrawObject> objects, const View& view,
                                       std::span<const ObjectTexture> textures = {});

// The picture of the full meshes in one view, to compare refinements with.
class FullMeshPicture {
 public:
  // The view outlives it, and so do the textures: one for each object, or none at all.
  FullMeshPicture(const std::vector<LoadedObject>& objects, const View& view,
                  std::span<const ObjectTexture> textures = {});

  [[nodiscard]] const ItemBuffer& items() const { return items_; }
  [[nodiscard]] const Image& image() const { return image_; }

  // Of a drawn refinement of the same objects in the same view.
  [[nodiscard]] PictureDistance distance_to(const ItemBuffer& items, std::span<const DrawObject> refined) const;
  // Likewise, see texture_slip_px(): with or without textures; none where nothing has texture coordinates.
  [[nodiscard]] std::optional<double> texture_slip_px(const ItemBuffer& items,
                                                      std::span<const DrawObject> refined) const;

 private:
  const View& view_;
  std::span<const ObjectTexture> textures_;
  std::vector<ObjectTexture> coordinates_;  // of each object
  ItemBuffer items_;
  Image image_;
  TexelBuffer texels_;  // empty where no object has texture coordinates
};

// Counts what occlusion hides wrongly. Reuses its memory from view to view.
class WronglyHidden {
 public:
  explicit WronglyHidden(const std::vector<LoadedObject>& objects);

  // Refines to a tolerance of 1 px without a budget and without any occlusion, otherwise as `options` say: what the
  // counts of this view are compared with. The view outlives them.
  void set_view(const View& view, const RefineOptions& options);
  // Of that reference.
  [[nodiscard]] const ItemBuffer& items() const { return without_; }
  [[nodiscard]] std::span<const DrawObject> drawn() const { return drawn_; }

  // Refines likewise with `visibility` and counts the pixels of the reference that the result cannot explain within the
  // two promised errors: something visible was held to be hidden. `options`: those of set_view(), but for what concerns
  // occlusion.
  [[nodiscard]] std::size_t count(const RefineOptions& options, Visibility& visibility);
  // The sum of the two promised errors of the last count().
  [[nodiscard]] double allowed_px() const { return allowed_px_; }

 private:
  const std::vector<LoadedObject>& objects_;
  Refiner reference_refiner_;  // of its own: what it refined is shown by drawn()
  Refiner refiner_;
  const View* view_ = nullptr;
  std::vector<DrawObject> drawn_;
  ItemBuffer without_;
  ItemBuffer with_;
  double reference_error_px_ = 0.0;
  double allowed_px_ = 0.0;
};

}  // namespace occlod::tool
