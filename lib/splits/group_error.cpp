#include "splits/group_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "splits/nearest_point.h"
#include "splits/positions.h"
#include "splits/surface_distance.h"

namespace occlod {
namespace {

constexpr double slack = 1.05;              // of the largest distance of a vertex: what a limit starts with
constexpr double least_share = 1.0 / 64.0;  // of what is known: smaller distances are not worth the search
constexpr double least_extent = 1e-6;       // likewise, of the group's extent

// Lists the faces at each vertex.
class VertexFaces {
 public:
  VertexFaces(std::span<const Triangle> faces, std::size_t vertices)
      : first_(vertices + 2, 0), faces_(3 * faces.size()) {
    for (const Triangle& t : faces)
      for (int k = 0; k < 3; ++k) ++first_[t[k] + 2];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    for (std::uint32_t f = 0; f < faces.size(); ++f)
      for (int k = 0; k < 3; ++k) faces_[first_[faces[f][k] + 1]++] = f;
  }

  [[nodiscard]] std::span<const std::uint32_t> at(VertexId v) const {
    return std::span(faces_).subspan(first_[v], first_[v + 1] - first_[v]);
  }

 private:
  std::vector<std::uint32_t> first_, faces_;
};

// Tells whether a surface covers triangles within a distance. The faces around a triangle are projected onto its plane.
// Those that are found from one by going across every side that crosses the triangle have no border over it, counted
// modulo 2, so they lie over all of it if an odd number of them lies over one point. Height is linear on each, and
// hence no larger than at their corners.
class CoverTest {
 public:
  CoverTest(const SurfaceView& surface, const SurfaceTree& tree) : surface_(surface), tree_(tree) {}

  // Returns whether every point of the triangle is found to be within `limit` of the surface. `start`: faces of it, of
  // which those that lie over the triangle are where the search begins.
  bool is_covered(const std::array<glm::dvec3, 3>& corners, std::span<const std::uint32_t> start, double limit) {
    if (!set_frame(corners, limit)) return false;
    for (const std::uint32_t face : start)
      if (is_over(image_of(face))) return flood(face);
    return false;
  }

 private:
  static constexpr std::size_t most_faces = 48;

  struct Image {
    std::array<glm::dvec3, 3>
        corners;                       // of a face: two coordinates along the triangle's plane, and the height above it
    std::array<glm::dvec3, 3> beyond;  // how far each lies beyond each side of the triangle; negative inside
  };

  static double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

  // Returns false for triangles that are too narrow to be projected onto.
  bool set_frame(const std::array<glm::dvec3, 3>& corners, double limit) {
    const glm::dvec3 ab = corners[1] - corners[0], ac = corners[2] - corners[0], normal = glm::cross(ab, ac);
    const double area = glm::length(normal);
    const double longest =
        std::sqrt(std::max({squared_length(ab), squared_length(ac), squared_length(corners[2] - corners[1])}));
    if (!(area > 0.0)) return false;
    const glm::dvec3 far = glm::max(glm::abs(corners[0]), glm::max(glm::abs(corners[1]), glm::abs(corners[2])));
    tolerance_ = 1e-13 * (std::max({far.x, far.y, far.z}) + longest);
    if (tolerance_ * longest * longest > 1e-3 * limit * area) return false;  // at the sharpest corner
    origin_ = corners[0];
    normal_ = normal / area;
    x_ = glm::normalize(ab);
    y_ = glm::cross(normal_, x_);
    limit_ = limit;
    for (std::size_t k = 0; k < 3; ++k) corners_[k] = flat(corners[k]);
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec2 along = corners_[(k + 1) % 3] - corners_[k];
      walls_[k] = glm::dvec2(along.y, -along.x) / glm::length(along);
    }
    middle_ = (corners_[0] + corners_[1] + corners_[2]) / 3.0;
    return true;
  }

  [[nodiscard]] glm::dvec2 flat(const glm::dvec3& p) const {
    return {glm::dot(x_, p - origin_), glm::dot(y_, p - origin_)};
  }

  [[nodiscard]] Image image_of(std::uint32_t face) const {
    Image image;
    for (int k = 0; k < 3; ++k) {
      const glm::dvec3 off = tree_.corner(face, k) - origin_;
      const auto i = static_cast<std::size_t>(k);
      image.corners[i] = {glm::dot(x_, off), glm::dot(y_, off), glm::dot(normal_, off)};
      for (int wall = 0; wall < 3; ++wall) image.beyond[i][wall] = beyond(wall, image.corners[i]);
    }
    return image;
  }

  // Returns how far a point lies beyond a side of the triangle, along its plane; negative inside.
  [[nodiscard]] double beyond(int wall, const glm::dvec2& p) const {
    return glm::dot(walls_[static_cast<std::size_t>(wall)], p - corners_[static_cast<std::size_t>(wall)]);
  }

  // Returns whether a side of the triangle has all of the face, or its side from corner k, beyond it.
  [[nodiscard]] bool is_beyond(const Image& image) const {
    const auto& [a, b, c] = image.beyond;
    const glm::dvec3 least = glm::min(a, glm::min(b, c));
    return std::max({least.x, least.y, least.z}) >= -tolerance_;
  }
  [[nodiscard]] bool is_beyond(const Image& image, std::size_t k) const {
    const glm::dvec3 least = glm::min(image.beyond[k], image.beyond[(k + 1) % 3]);
    return std::max({least.x, least.y, least.z}) >= -tolerance_;
  }

  // Returns whether the side that begins at corner k has points inside the triangle.
  [[nodiscard]] bool crosses(const Image& image, std::size_t k) const {
    if (is_beyond(image, k)) return false;
    const glm::dvec2 p(image.corners[k]), along = glm::dvec2(image.corners[(k + 1) % 3]) - p;
    const double reach = tolerance_ * (std::abs(along.x) + std::abs(along.y));
    const double a = cross(along, corners_[0] - p), b = cross(along, corners_[1] - p),
                 c = cross(along, corners_[2] - p);
    return std::max({a, b, c}) > reach && std::min({a, b, c}) < -reach;
  }

  [[nodiscard]] bool is_over(const Image& image) const {
    return !is_beyond(image) &&
           (crosses(image, 0) || crosses(image, 1) || crosses(image, 2) || contains(image, middle_));
  }

  static bool contains(const Image& image, const glm::dvec2& p) {
    const glm::dvec2 a = glm::dvec2(image.corners[0]) - p, b = glm::dvec2(image.corners[1]) - p,
                     c = glm::dvec2(image.corners[2]) - p;
    const double ab = cross(a, b), bc = cross(b, c), ca = cross(c, a);
    return (ab > 0.0 && bc > 0.0 && ca > 0.0) || (ab < 0.0 && bc < 0.0 && ca < 0.0);
  }

  // Returns whether what lies over the triangle is within the limit: at the corners of that polygon.
  [[nodiscard]] bool is_low(const Image& image) const {
    const auto low = [&](const glm::dvec3& p) { return std::abs(p.z) <= limit_; };
    if (std::all_of(image.corners.begin(), image.corners.end(), low)) return true;
    std::array<glm::dvec3, 8> inside{}, rest{};  // six at most, but for rounding
    std::copy(image.corners.begin(), image.corners.end(), inside.begin());
    std::size_t size = 3;
    for (int wall = 0; wall < 3; ++wall) {
      std::size_t kept = 0;
      for (std::size_t i = 0; i < size; ++i) {
        if (kept + 2 > rest.size()) return false;
        const glm::dvec3 &p = inside[i], &q = inside[i + 1 == size ? 0 : i + 1];
        const double at_p = beyond(wall, p), at_q = beyond(wall, q);
        if (at_p <= 0.0) rest[kept++] = p;
        if ((at_p > 0.0 && at_q < 0.0) || (at_p < 0.0 && at_q > 0.0)) rest[kept++] = p + at_p / (at_p - at_q) * (q - p);
      }
      inside = rest;
      size = kept;
    }
    return std::all_of(inside.begin(), inside.begin() + static_cast<std::ptrdiff_t>(size), low);
  }

  bool flood(std::uint32_t start) {
    found_.assign(1, start);
    bool is_odd = false;
    for (std::size_t i = 0; i < found_.size(); ++i) {
      const Image image = image_of(found_[i]);
      if (!is_low(image)) return false;
      is_odd = is_odd != contains(image, middle_);
      for (int k = 0; k < 3; ++k) {
        if (!crosses(image, static_cast<std::size_t>(k))) continue;
        const std::uint32_t next = tree_.neighbour(found_[i], k);
        if (next == no_id || !are_neighbours(next, found_[i], k)) return false;
        if (std::find(found_.begin(), found_.end(), next) != found_.end()) continue;
        if (found_.size() == most_faces) return false;
        found_.push_back(next);
      }
    }
    return is_odd;
  }

  // Returns whether `next` names `face` as its neighbour across the side of `face` that begins at corner k.
  [[nodiscard]] bool are_neighbours(std::uint32_t next, std::uint32_t face, int k) const {
    const VertexId from = surface_.faces[face][k], to = surface_.faces[face][(k + 1) % 3];
    for (int j = 0; j < 3; ++j) {
      const VertexId a = surface_.faces[next][j], b = surface_.faces[next][(j + 1) % 3];
      if (((a == to && b == from) || (a == from && b == to)) && tree_.neighbour(next, j) == face) return true;
    }
    return false;
  }

  SurfaceView surface_;
  const SurfaceTree& tree_;
  glm::dvec3 origin_{}, normal_{}, x_{}, y_{};
  double limit_ = 0.0, tolerance_ = 0.0;
  std::array<glm::dvec2, 3> corners_, walls_;  // walls: outwards from the sides, unit length
  glm::dvec2 middle_{};
  std::vector<std::uint32_t> found_;
};

// Raises a limit until all of both surfaces is known to be within it of the other. Most faces are settled at once: what
// lies over one face by its corners, what a CoverTest finds near, and what the collapses are known not to have moved
// farther. limit_of() measures the others.
class GroupMeasurer {
 public:
  GroupMeasurer(const TriangleMesh& mesh, const SimplifiedGroup& simplified)
      : mesh_(mesh),
        simplified_(simplified),
        fine_{mesh.positions, mesh.triangles},
        coarse_{simplified.positions.empty() ? std::span<const glm::vec3>(mesh.positions) : simplified.positions,
                simplified.triangles},
        coarse_faces_(simplified.triangles, mesh.vertex_count()),
        places_(mesh.vertex_count()),
        most_(static_cast<double>(simplified.guaranteed_error)) {
    list_images();
  }

  double run() {
    const Box box = bounding_box(std::span(mesh_.positions));
    const double extent = glm::distance(glm::dvec3(box.min), glm::dvec3(box.max));
    limit_ = std::max({least_share * most_, least_extent * extent, vanished()});
    if (limit_ < most_) measure_fine();
    if (limit_ < most_) measure_coarse();
    return std::min(limit_, most_);
  }

 private:
  // A vertex of the group on the simplified surface.
  struct Place {
    std::uint32_t face = no_id;  // a face that is near
    double distance2 = std::numeric_limits<double>::infinity();
  };

  // Measures the group from the simplified surface.
  void measure_fine() {
    place_vertices();
    const SurfaceTree tree(coarse_);
    limit_ = std::max(limit_, slack * farthest(limit_ / slack, tree));
    CoverTest cover(coarse_, tree);
    std::vector<DoubtfulFace> doubtful;
    for (std::uint32_t f = 0; f < mesh_.triangles.size(); ++f)
      if (!is_vanished(mesh_.triangles[f]) && !is_near(mesh_.triangles[f], cover)) doubtful.push_back({f, most_});
    limit_ = limit_of(fine_, doubtful, tree, limit_, most_);
  }

  // Measures the simplified surface from the group.
  void measure_coarse() {
    const SurfaceTree tree(fine_);
    const VertexFaces fine_faces(mesh_.triangles, mesh_.vertex_count());
    CoverTest cover(fine_, tree);
    std::vector<DoubtfulFace> doubtful;
    for (std::uint32_t f = 0; f < simplified_.triangles.size(); ++f) {
      const Triangle& t = simplified_.triangles[f];
      const auto bound = static_cast<double>(simplified_.bounds[f]);
      const std::array corners = {place(t.x), place(t.y), place(t.z)};
      if (bound > limit_ && !cover.is_covered(corners, fine_faces.at(t.x), limit_) &&
          !cover.is_covered(corners, fine_faces.at(t.y), limit_) &&
          !cover.is_covered(corners, fine_faces.at(t.z), limit_))
        doubtful.push_back({f, bound});
    }
    limit_ = limit_of(coarse_, doubtful, tree, limit_, most_);
  }

  [[nodiscard]] glm::dvec3 position(VertexId v) const { return glm::dvec3(mesh_.positions[v]); }
  // Returns where a vertex is on the simplified surface.
  [[nodiscard]] glm::dvec3 place(VertexId v) const { return glm::dvec3(coarse_.positions[v]); }
  [[nodiscard]] double distance2(const glm::dvec3& p, std::uint32_t face) const {
    const Triangle& t = simplified_.triangles[face];
    return nearest_point(p, place(t.x), place(t.y), place(t.z)).distance2;
  }

  // Finds the vertices into which those of the group were merged.
  void list_images() {
    const std::size_t wedges = mesh_.wedge_count();
    for (VertexId v = 0; v < mesh_.vertex_count(); ++v) {
      const WedgeId into = simplified_.merged_into[v];
      image_.push_back(into < wedges ? mesh_.vertex_of(into) : simplified_.added[into - wedges].vertex);
    }
  }

  [[nodiscard]] bool is_vanished(const Triangle& t) const {
    return coarse_faces_.at(image_[t.x]).empty() && coarse_faces_.at(image_[t.y]).empty() &&
           coarse_faces_.at(image_[t.z]).empty();
  }

  // Returns the extent of what has vanished, as distances from the vertex that was left last.
  [[nodiscard]] double vanished() const {
    double most2 = 0.0;
    for (const Triangle& t : mesh_.triangles)
      if (is_vanished(t))
        for (int k = 0; k < 3; ++k) most2 = std::max(most2, squared_length(position(t[k]) - position(image_[t.x])));
    return std::sqrt(most2);
  }

  // Finds the nearest face at the image of each vertex.
  void place_vertices() {
    for (VertexId v = 0; v < places_.size(); ++v)
      for (const std::uint32_t face : coarse_faces_.at(image_[v])) {
        const double d2 = image_[v] == v && position(v) == place(v) ? 0.0 : distance2(position(v), face);
        if (d2 < places_[v].distance2) places_[v] = {face, d2};
        if (d2 == 0.0) break;
      }
  }

  // Returns the largest distance of any vertex from the surface, or `least` if that is more.
  double farthest(double least, const SurfaceTree& tree) {
    std::vector<VertexId> order;
    for (VertexId v = 0; v < places_.size(); ++v)
      if (places_[v].face != no_id && places_[v].distance2 > least * least) order.push_back(v);
    std::sort(order.begin(), order.end(), [&](VertexId a, VertexId b) {
      return std::pair(places_[b].distance2, a) < std::pair(places_[a].distance2, b);
    });
    double most2 = least * least;
    for (const VertexId v : order) {
      if (places_[v].distance2 <= slack * slack * most2) break;
      const SurfaceTree::Found found = tree.nearest(position(v), most2, places_[v].face);
      places_[v] = {found.face, found.distance2};
      most2 = std::max(most2, found.distance2);
    }
    return std::sqrt(most2);
  }

  // Returns whether all of a triangle of the group is found to be near the faces at its corners. A face is convex: what
  // has its corners near it is near.
  [[nodiscard]] bool is_near(const Triangle& t, CoverTest& cover) const {
    const double limit2 = limit_ * limit_;
    std::array<std::uint32_t, 3> faces{};
    std::array<glm::dvec3, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexId v = t[static_cast<int>(k)];
      if (!(places_[v].distance2 <= limit2)) return false;
      faces[k] = places_[v].face;
      corners[k] = position(v);
    }
    for (std::size_t k = 0; k < 3; ++k)
      if ((k == 0 || faces[k] != faces[0]) && distance2(corners[(k + 1) % 3], faces[k]) <= limit2 &&
          distance2(corners[(k + 2) % 3], faces[k]) <= limit2)
        return true;
    return cover.is_covered(corners, faces, limit_);
  }

  const TriangleMesh& mesh_;
  const SimplifiedGroup& simplified_;
  const SurfaceView fine_, coarse_;
  const VertexFaces coarse_faces_;
  std::vector<VertexId> image_;  // per vertex of the group: what it was merged into
  std::vector<Place> places_;    // per vertex of the group
  const double most_;            // no distance exceeds it
  double limit_ = 0.0;
};

}  // namespace

float measured_error(const TriangleMesh& mesh, const SimplifiedGroup& simplified) {
  if (simplified.triangles.empty() || simplified.guaranteed_error == 0.0F) return simplified.guaranteed_error;
  const double bound = GroupMeasurer(mesh, simplified).run();
  return std::min(simplified.guaranteed_error, scaled_up(static_cast<float>(bound), 1.0F + 1e-6F));
}

}  // namespace occlod
