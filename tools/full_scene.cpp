#include "full_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <limits>
#include <map>

#include "occlod/base.h"
#include "occlod/build_hierarchy.h"

namespace occlod::tool {
namespace {

constexpr std::uint32_t chunk_triangles = 1024;
constexpr int tile_size = 8;               // pixels
constexpr std::size_t chunks_a_look = 64;  // drawn between two looks at the depth

struct Part {
  Box box;
  std::uint32_t first = 0, count = 0;  // of the triangles
};

// Holds pixels, excluding the last column and row.
struct Rectangle {
  int left = 0, top = 0, right = 0, bottom = 0;
};

// Holds the farthest depth in each tile of an image.
class FarthestDepth {
 public:
  void look_at(const DepthBuffer& depth) {
    width_ = (depth.width + tile_size - 1) / tile_size;
    height_ = (depth.height + tile_size - 1) / tile_size;
    farthest_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_),
                     std::numeric_limits<float>::infinity());
    std::size_t pixel = 0;
    for (int y = 0; y < depth.height; ++y)
      for (int x = 0; x < depth.width; ++x, ++pixel) {
        float& tile = at(x / tile_size, y / tile_size);
        tile = std::min(tile, depth.nearness[pixel]);
      }
  }

  // Returns whether every pixel in the rectangle is nearer.
  [[nodiscard]] bool hides(const Rectangle& pixels, double nearness) {
    if (farthest_.empty()) return false;
    for (int y = pixels.top / tile_size; y <= (pixels.bottom - 1) / tile_size; ++y)
      for (int x = pixels.left / tile_size; x <= (pixels.right - 1) / tile_size; ++x)
        if (!(static_cast<double>(at(x, y)) > nearness)) return false;
    return true;
  }

 private:
  float& at(int x, int y) { return farthest_[static_cast<std::size_t>(y * width_ + x)]; }

  int width_ = 0, height_ = 0;
  std::vector<float> farthest_;
};

}  // namespace

struct FullScene::Mesh {
  explicit Mesh(const Hierarchy& hierarchy) : triangles(triangles_of(hierarchy, full_cut(hierarchy))) {
    divide(hierarchy.positions(), 0, static_cast<std::uint32_t>(triangles.size()));
  }

  // Divides at the median of the longest axis until parts are small.
  void divide(std::span<const glm::vec3> positions, std::uint32_t first, std::uint32_t count) {
    Box box{glm::vec3(std::numeric_limits<float>::infinity()), glm::vec3(-std::numeric_limits<float>::infinity())};
    for (std::uint32_t i = first; i < first + count; ++i)
      for (int k = 0; k < 3; ++k) {
        box.min = glm::min(box.min, positions[triangles[i][k]]);
        box.max = glm::max(box.max, positions[triangles[i][k]]);
      }
    if (count <= chunk_triangles) {
      if (count > 0) parts.push_back({box, first, count});
      return;
    }
    const glm::vec3 size = box.max - box.min;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const auto key = [&](const Triangle& t) {
      return positions[t.x][axis] + positions[t.y][axis] + positions[t.z][axis];
    };
    const auto begin = triangles.begin() + first;
    std::nth_element(begin, begin + count / 2, begin + count,
                     [&](const Triangle& a, const Triangle& b) { return key(a) < key(b); });
    divide(positions, first, count / 2);
    divide(positions, first + count / 2, count - count / 2);
  }

  std::vector<Triangle> triangles;
  std::vector<Part> parts;
};

// Names a part of a mesh that may be visible in a view.
struct FullScene::Chunk {
  std::uint32_t mesh = 0, part = 0;
  double nearness = 0.0;  // upper bound
  Rectangle pixels;       // contain the whole chunk
};

FullScene::FullScene(std::span<const RefineObject> objects) {
  std::map<const Hierarchy*, std::shared_ptr<const Mesh>> made;
  std::uint64_t items = 0;
  for (const RefineObject& object : objects) {
    std::shared_ptr<const Mesh>& mesh = made[object.hierarchy];
    if (!mesh) mesh = std::make_shared<const Mesh>(*object.hierarchy);
    meshes_.push_back({mesh, object, static_cast<std::uint32_t>(items)});
    items += mesh->triangles.size();
    if (items >= no_item) throw Error({"the scene", "", "has 2^32 triangles or more", "leave out objects"});
  }
}

FullScene::~FullScene() = default;

void FullScene::find_chunks(const View& view, std::vector<Chunk>& chunks) const {
  for (std::uint32_t m = 0; m < meshes_.size(); ++m) {
    const glm::dmat4 to_clip = view.world_to_clip() * meshes_[m].object.object_to_world;
    const std::vector<Part>& parts = meshes_[m].mesh->parts;
    for (std::uint32_t p = 0; p < parts.size(); ++p) {
      const Box& box = parts[p].box;
      glm::dvec2 low(std::numeric_limits<double>::infinity()), high = -low;
      double nearest = std::numeric_limits<double>::infinity(), farthest = -nearest;  // distances
      for (unsigned corner = 0; corner < 8; ++corner) {
        const glm::dvec3 place((corner & 1U) != 0 ? box.max.x : box.min.x, (corner & 2U) != 0 ? box.max.y : box.min.y,
                               (corner & 4U) != 0 ? box.max.z : box.min.z);
        const glm::dvec4 clip = to_clip * glm::dvec4(place, 1.0);
        nearest = std::min(nearest, clip.w);
        farthest = std::max(farthest, clip.w);
        low = glm::min(low, glm::dvec2(clip) / clip.w);
        high = glm::max(high, glm::dvec2(clip) / clip.w);
      }
      if (farthest < 0.999 * view.camera().near) continue;
      Chunk chunk{m, p, std::numeric_limits<double>::infinity(), {0, 0, view.width(), view.height()}};
      if (nearest > view.camera().near) {
        const auto pixel = [](double ndc, int size) {
          return static_cast<int>(std::floor(std::clamp(0.5 * (ndc + 1.0), -1.0, 2.0) * size));
        };
        chunk.nearness = 1.001 / nearest;  // with room for rounding
        chunk.pixels = {std::max(pixel(low.x, view.width()) - 1, 0), std::max(pixel(-high.y, view.height()) - 1, 0),
                        std::min(pixel(high.x, view.width()) + 2, view.width()),
                        std::min(pixel(-low.y, view.height()) + 2, view.height())};
        if (chunk.pixels.left >= chunk.pixels.right || chunk.pixels.top >= chunk.pixels.bottom) continue;
      }
      chunks.push_back(chunk);
    }
  }
}

void FullScene::draw(ItemBuffer& target, const View& view) const {
  target.reset(view.width(), view.height());
  std::vector<Chunk> chunks;
  find_chunks(view, chunks);
  std::stable_sort(chunks.begin(), chunks.end(),
                   [](const Chunk& a, const Chunk& b) { return a.nearness > b.nearness; });
  std::vector<glm::mat4> to_clip;
  for (const PlacedMesh& placed : meshes_)
    to_clip.push_back(ObjectView(view, placed.object.object_to_world).object_to_clip());
  FarthestDepth depth;
  std::size_t drawn = 0;
  for (const Chunk& chunk : chunks) {
    if (depth.hides(chunk.pixels, chunk.nearness)) continue;
    const PlacedMesh& placed = meshes_[chunk.mesh];
    const Part& part = placed.mesh->parts[chunk.part];
    draw_items(target, placed.object.hierarchy->positions(),
               std::span(placed.mesh->triangles).subspan(part.first, part.count), to_clip[chunk.mesh],
               placed.first_item + part.first);
    if (++drawn % chunks_a_look == 0) depth.look_at(target.depth);
  }
}

std::size_t FullScene::triangle_count() const noexcept {
  return meshes_.empty() ? 0 : meshes_.back().first_item + meshes_.back().mesh->triangles.size();
}

std::size_t FullScene::triangles_in_view(const View& view) const {
  std::vector<Chunk> chunks;
  find_chunks(view, chunks);
  std::size_t triangles = 0;
  for (const Chunk& chunk : chunks) triangles += meshes_[chunk.mesh].mesh->parts[chunk.part].count;
  return triangles;
}

FullScene::Item FullScene::item(std::uint32_t item) const {
  const auto after = std::upper_bound(meshes_.begin() + 1, meshes_.end(), item,
                                      [](std::uint32_t i, const PlacedMesh& mesh) { return i < mesh.first_item; });
  const PlacedMesh& placed = *(after - 1);
  return {static_cast<std::size_t>(after - 1 - meshes_.begin()), placed.mesh->triangles[item - placed.first_item]};
}

}  // namespace occlod::tool
