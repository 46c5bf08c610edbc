#include "texture_tree.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace occlod::measure {
namespace {

constexpr std::size_t max_in_leaf = 4;

TextureBox box_of(const TriangleMesh& mesh, std::uint32_t triangle) {
  const Triangle& t = mesh.wedge_triangles()[triangle];
  const auto texture = [&](int i) {
    return mesh.texture_coordinates.empty() ? glm::dvec2(0.0) : glm::dvec2(mesh.texture_coordinates[t[i]]);
  };
  TextureBox box{glm::dvec3(mesh.positions[t.x]), glm::dvec3(mesh.positions[t.x]), texture(0), texture(0)};
  for (int i = 1; i < 3; ++i) {
    box.low = glm::min(box.low, glm::dvec3(mesh.positions[t[i]]));
    box.high = glm::max(box.high, glm::dvec3(mesh.positions[t[i]]));
    box.texture_low = glm::min(box.texture_low, texture(i));
    box.texture_high = glm::max(box.texture_high, texture(i));
  }
  return box;
}

TextureBox joined(const TextureBox& a, const TextureBox& b) {
  return {glm::min(a.low, b.low), glm::max(a.high, b.high), glm::min(a.texture_low, b.texture_low),
          glm::max(a.texture_high, b.texture_high)};
}

}  // namespace

class TextureTree::Builder {
 public:
  Builder(TextureTree& tree, const TriangleMesh& mesh, double texture_scale)
      : tree_(tree), texture_scale_(texture_scale) {
    boxes_.reserve(tree.triangles_.size());
    for (const std::uint32_t triangle : tree.triangles_) boxes_.emplace_back(triangle, box_of(mesh, triangle));
  }

  void build() {
    (void)add(0, boxes_.size());
    for (std::size_t i = 0; i < boxes_.size(); ++i) tree_.triangles_[i] = boxes_[i].first;
  }

 private:
  using Boxed = std::pair<std::uint32_t, TextureBox>;

  std::uint32_t add(std::size_t begin, std::size_t end) {
    TextureBox box = boxes_[begin].second;
    for (std::size_t i = begin + 1; i < end; ++i) box = joined(box, boxes_[i].second);
    const auto id = static_cast<std::uint32_t>(tree_.nodes_.size());
    tree_.nodes_.push_back({box, static_cast<std::uint32_t>(begin), 0, static_cast<std::uint32_t>(end - begin)});
    if (end - begin <= max_in_leaf) return id;
    const std::size_t middle = begin + (end - begin) / 2;
    const int axis = longest_axis(box);
    const auto at = [&](std::size_t i) { return boxes_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(middle), at(end), [&](const Boxed& a, const Boxed& b) {
      return std::pair(middle_of(a.second, axis), a.first) < std::pair(middle_of(b.second, axis), b.first);
    });
    const std::uint32_t first = add(begin, middle), second = add(middle, end);
    tree_.nodes_[id].first = first;
    tree_.nodes_[id].second = second;
    tree_.nodes_[id].count = 0;
    return id;
  }

  [[nodiscard]] int longest_axis(const TextureBox& box) const {
    const glm::dvec3 size = box.high - box.low;
    const glm::dvec2 texture_size = texture_scale_ * (box.texture_high - box.texture_low);
    const std::array<double, 5> sizes = {size.x, size.y, size.z, texture_size.x, texture_size.y};
    return static_cast<int>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
  }

  static double middle_of(const TextureBox& box, int axis) {
    return axis < 3 ? box.low[axis] + box.high[axis] : box.texture_low[axis - 3] + box.texture_high[axis - 3];
  }

  TextureTree& tree_;
  double texture_scale_;
  std::vector<Boxed> boxes_;
};

TextureTree::TextureTree(const TriangleMesh& mesh, std::vector<std::uint32_t> triangles, double texture_scale)
    : triangles_(std::move(triangles)) {
  assert(!triangles_.empty());
  nodes_.reserve(triangles_.size());
  Builder(*this, mesh, texture_scale).build();
}

}  // namespace occlod::measure
