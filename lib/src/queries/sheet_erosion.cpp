#include "queries/sheet_erosion.h"

#include <algorithm>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>
#include <tuple>

namespace occlod {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// Every point of a triangle is within this share of its longest edge of a corner.
constexpr double farthest_from_corners = 0.5774;

double smallest_height(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const double longest = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
  return longest > 0.0 ? glm::length(glm::cross(b - a, c - a)) / longest : 0.0;
}

}  // namespace

std::span<const std::uint8_t> SheetErosion::kept(std::span<const SheetFace> faces, std::span<const glm::vec3> positions,
                                                 const glm::vec3& eye) {
  number_vertices(faces, positions, eye);
  measure(faces, positions, eye);
  find_border();
  list_faces_of_vertices();
  spread();
  kept_.resize(faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const glm::uvec3& t = corners_[f];
    // A face that is moved by its error as well moves by no more than its radius as seen from the eye.
    kept_[f] = std::min({margin_[t.x], margin_[t.y], margin_[t.z]}) >= radius_[f] ? 1 : 0;
  }
  return kept_;
}

void SheetErosion::number_vertices(std::span<const SheetFace> faces, std::span<const glm::vec3> positions,
                                   const glm::vec3& eye) {
  vertices_.clear();
  for (const SheetFace& face : faces)
    for (int k = 0; k < 3; ++k) vertices_.push_back(face.corners[k]);
  std::sort(vertices_.begin(), vertices_.end());
  vertices_.erase(std::unique(vertices_.begin(), vertices_.end()), vertices_.end());
  directions_.clear();
  for (const std::uint32_t v : vertices_)
    directions_.push_back(glm::normalize(glm::dvec3(positions[v]) - glm::dvec3(eye)));
  corners_.clear();
  const auto local = [&](std::uint32_t v) {
    return static_cast<std::uint32_t>(std::lower_bound(vertices_.begin(), vertices_.end(), v) - vertices_.begin());
  };
  for (const SheetFace& face : faces)
    corners_.emplace_back(local(face.corners.x), local(face.corners.y), local(face.corners.z));
}

void SheetErosion::measure(std::span<const SheetFace> faces, std::span<const glm::vec3> positions,
                           const glm::vec3& eye) {
  height_.clear();
  radius_.clear();
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const glm::uvec3& t = corners_[f];
    height_.push_back(smallest_height(directions_[t.x], directions_[t.y], directions_[t.z]));
    double nearest = infinity, longest = 0.0;
    for (int k = 0; k < 3; ++k) {
      const glm::dvec3 p(positions[faces[f].corners[k]]), next(positions[faces[f].corners[(k + 1) % 3]]);
      nearest = std::min(nearest, glm::distance(p, glm::dvec3(eye)));
      longest = std::max(longest, glm::distance(p, next));
    }
    const double error = static_cast<double>(faces[f].error);
    const double room = nearest - farthest_from_corners * longest - error;
    radius_.push_back(error == 0.0 ? 0.0 : room > 0.0 ? error / room : infinity);
  }
}

void SheetErosion::find_border() {
  edges_.clear();
  for (std::uint32_t f = 0; f < corners_.size(); ++f)
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = std::min(corners_[f][k], corners_[f][(k + 1) % 3]);
      const std::uint32_t b = std::max(corners_[f][k], corners_[f][(k + 1) % 3]);
      const glm::dvec3 plane = glm::cross(directions_[a], directions_[b]);
      edges_.push_back({a, b, f, glm::dot(plane, directions_[corners_[f][(k + 2) % 3]]) > 0.0});
    }
  std::sort(edges_.begin(), edges_.end(),
            [](const Edge& x, const Edge& y) { return std::tie(x.a, x.b, x.face) < std::tie(y.a, y.b, y.face); });
  margin_.assign(vertices_.size(), infinity);
  for (std::size_t i = 0; i < edges_.size();) {
    std::size_t end = i + 1;
    while (end < edges_.size() && edges_[end].a == edges_[i].a && edges_[end].b == edges_[i].b) ++end;
    mark_border(std::span(edges_).subspan(i, end - i));
    i = end;
  }
}

void SheetErosion::mark_border(std::span<const Edge> same) {
  const auto is_left = [](const Edge& e) { return e.left; };
  if (std::any_of(same.begin(), same.end(), is_left) && !std::all_of(same.begin(), same.end(), is_left)) return;
  double radius = 0.0;
  for (const Edge& e : same) radius = std::max(radius, radius_[e.face]);
  for (const std::uint32_t v : {same[0].a, same[0].b}) margin_[v] = std::min(margin_[v], -radius);
}

void SheetErosion::list_faces_of_vertices() {
  first_face_.assign(vertices_.size() + 1, 0);
  for (const glm::uvec3& t : corners_)
    for (int k = 0; k < 3; ++k) ++first_face_[t[k] + 1];
  for (std::size_t v = 0; v < vertices_.size(); ++v) first_face_[v + 1] += first_face_[v];
  face_list_.resize(3 * corners_.size());
  next_.assign(first_face_.begin(), first_face_.end() - 1);
  for (std::uint32_t f = 0; f < corners_.size(); ++f)
    for (int k = 0; k < 3; ++k) face_list_[next_[corners_[f][k]]++] = f;
}

// Dijkstra, a face's smallest height from any of its corners to any other.
void SheetErosion::spread() {
  queue_.clear();
  const auto later = std::greater<>();
  for (std::uint32_t v = 0; v < margin_.size(); ++v)
    if (margin_[v] < infinity) queue_.emplace_back(margin_[v], v);
  std::make_heap(queue_.begin(), queue_.end(), later);
  while (!queue_.empty()) {
    std::pop_heap(queue_.begin(), queue_.end(), later);
    const auto [margin, v] = queue_.back();
    queue_.pop_back();
    if (margin > margin_[v]) continue;
    for (std::uint32_t i = first_face_[v]; i < first_face_[v + 1]; ++i)
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t w = corners_[face_list_[i]][k];
        const double through = margin + height_[face_list_[i]];
        if (!(through < margin_[w])) continue;
        margin_[w] = through;
        queue_.emplace_back(through, w);
        std::push_heap(queue_.begin(), queue_.end(), later);
      }
  }
}

}  // namespace occlod
