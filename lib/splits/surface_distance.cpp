#include "splits/surface_distance.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numeric>
#include <utility>

#include "base/threads.h"
#include "splits/nearest_point.h"

namespace occlod {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr Box no_box{glm::vec3(infinity), glm::vec3(-infinity)};

void unite(Box& box, const glm::vec3& low, const glm::vec3& high) {
  box.min = glm::min(box.min, low);
  box.max = glm::max(box.max, high);
}

double distance2_to(const Box& box, const glm::dvec3& p) {
  const glm::dvec3 off = glm::max(glm::max(glm::dvec3(box.min) - p, p - glm::dvec3(box.max)), 0.0);
  return squared_length(off);
}

// A convex polygon in space.
class Polygon {
 public:
  static constexpr std::size_t capacity = 12;

  void add(const glm::dvec3& corner) { corners_[size_++] = corner; }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] const glm::dvec3* begin() const { return corners_.data(); }
  [[nodiscard]] const glm::dvec3* end() const { return corners_.data() + size_; }
  [[nodiscard]] const glm::dvec3& operator[](std::size_t i) const { return corners_[i]; }
  [[nodiscard]] glm::dvec3 middle() const {
    glm::dvec3 sum(0.0);
    for (const glm::dvec3& p : *this) sum += p;
    return sum / static_cast<double>(size_);
  }
  [[nodiscard]] double area() const {
    glm::dvec3 twice(0.0);
    for (std::size_t i = 2; i < size_; ++i)
      twice += glm::cross(corners_[i - 1] - corners_[0], corners_[i] - corners_[0]);
    return 0.5 * glm::length(twice);
  }

 private:
  std::array<glm::dvec3, capacity> corners_;
  std::size_t size_ = 0;
};

// A face with the walls that stand on its sides, outwards.
class WalledFace {
 public:
  WalledFace(const SurfaceTree& tree, std::uint32_t face)
      : corners_{tree.corner(face, 0), tree.corner(face, 1), tree.corner(face, 2)} {
    const glm::dvec3 normal = glm::cross(corners_[1] - corners_[0], corners_[2] - corners_[0]);
    normal_ = unit(normal);
    for (std::size_t k = 0; k < 3; ++k) walls_[k] = unit(glm::cross(corners_[(k + 1) % 3] - corners_[k], normal));
  }

  // Returns how far beyond a wall the point lies; negative inside.
  [[nodiscard]] double beyond_wall(std::size_t k, const glm::dvec3& p) const {
    return glm::dot(walls_[k], p - corners_[k]);
  }
  // Returns whether the point is within a distance, given by its square, of the face. The foot on its plane decides
  // where that lies within the walls, or too far beyond one.
  [[nodiscard]] bool is_near(const glm::dvec3& p, double limit2) const {
    const double height = glm::dot(normal_, p - corners_[0]);
    const double beyond = std::max({beyond_wall(0, p), beyond_wall(1, p), beyond_wall(2, p), 0.0});
    if (height * height + beyond * beyond > limit2) return false;
    return (beyond == 0.0 && normal_ != glm::dvec3(0.0)) ||
           nearest_point(p, corners_[0], corners_[1], corners_[2]).distance2 <= limit2;
  }

 private:
  static glm::dvec3 unit(const glm::dvec3& v) {
    const double length2 = squared_length(v);
    return length2 > 0.0 ? v / std::sqrt(length2) : glm::dvec3(0.0);
  }

  std::array<glm::dvec3, 3> corners_, walls_;
  glm::dvec3 normal_;
};

// Measures the faces of one range.
class FaceMeasurer {
 public:
  FaceMeasurer(const SurfaceTree& to, double limit, int most_pieces = std::numeric_limits<int>::max())
      : to_(to), limit_(limit), limit2_(limit * limit), most_pieces_(most_pieces) {}

  void set_limit(double limit) {
    limit_ = limit;
    limit2_ = limit * limit;
  }

  // Returns a face of the other surface near the point of the triangle that is too far, if there is one.
  std::optional<std::uint32_t> beyond(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    pieces_.clear();
    add_triangle(a, b, c);
    for (int tried = 0; !pieces_.empty(); ++tried) {
      if (tried == most_pieces_) return near_;
      const Piece piece = pieces_.back();
      pieces_.pop_back();
      if (!measure(piece)) return near_;
    }
    return std::nullopt;
  }

 private:
  struct Piece {
    Polygon polygon;
    std::uint32_t near = no_id;  // a face that is probably near
  };

  // Returns false when a point of the piece is too far. What is not known yet becomes pieces. Most pieces lie over the
  // face beside that over which the one before lay, so the nearest face need not be searched.
  bool measure(const Piece& piece) {
    constexpr double exactness = 0.02;
    const Polygon& polygon = piece.polygon;
    const glm::dvec3 middle = polygon.middle();
    double radius2 = 0.0;
    for (const glm::dvec3& p : polygon) radius2 = std::max(radius2, squared_length(p - middle));
    const double radius = std::sqrt(radius2);
    if (piece.near != no_id) {
      near_ = piece.near;
      WalledFace face(to_, near_);
      if (is_near(face, polygon)) return true;
      if (walk_to(middle, face) && is_near(face, polygon)) return true;
      if (cut_at(face, polygon, radius)) return true;
    }
    const std::uint32_t tried = near_;
    const double enough = std::max(limit_ - radius, 0.0);  // then all of the piece is near
    const SurfaceTree::Found found = to_.nearest(middle, enough * enough, near_);
    near_ = found.face;
    if (found.distance2 > limit2_) return false;
    if (found.distance2 <= enough * enough) return true;
    if (near_ == tried) return radius > exactness * limit_ && (divide(polygon, middle), true);
    const WalledFace face(to_, near_);
    if (is_near(face, polygon)) return true;
    if (radius <= exactness * limit_) return false;
    if (!cut_at(face, polygon, radius)) divide(polygon, middle);
    return true;
  }

  // Goes from the near face to that over which the point lies, if few others lie between. Returns whether it is
  // another.
  bool walk_to(const glm::dvec3& p, WalledFace& face) {
    constexpr int most_steps = 4;
    const std::uint32_t start = near_;
    for (int step = 0; step < most_steps; ++step) {
      const std::array<double, 3> beyond = {face.beyond_wall(0, p), face.beyond_wall(1, p), face.beyond_wall(2, p)};
      const auto most = std::max_element(beyond.begin(), beyond.end());
      const std::uint32_t next = *most > 0.0 ? to_.neighbour(near_, static_cast<int>(most - beyond.begin())) : no_id;
      if (next == no_id) break;
      near_ = next;
      face = WalledFace(to_, near_);
    }
    return near_ != start;
  }

  [[nodiscard]] bool is_near(const WalledFace& face, const Polygon& piece) const {
    return std::all_of(piece.begin(), piece.end(), [&](const glm::dvec3& p) { return face.is_near(p, limit2_); });
  }

  // Cuts the piece along the walls of the near face. Returns false, with no new pieces, when that does not help: when
  // what lies over the face is too little, all, or not near it everywhere.
  bool cut_at(const WalledFace& face, const Polygon& piece, double radius) {
    constexpr double least_share = 1.0 / 16.0;
    const double least_area = 1e-6 * limit_ * radius;  // what is so narrow is as near as what it was cut from
    const std::size_t before = pieces_.size();
    Polygon rest = piece;
    for (std::size_t k = 0; k < 3 && rest.size() >= 3; ++k) {
      if (rest.size() + 1 >= Polygon::capacity) break;
      const auto [inside, outside] = cut(rest, face, k);
      if (outside.size() >= 3 && outside.area() > least_area)
        pieces_.push_back({outside, to_.neighbour(near_, static_cast<int>(k))});
      rest = inside;
    }
    if (pieces_.size() > before && rest.size() >= 3 && rest.area() > least_share * piece.area() && is_near(face, rest))
      return true;
    pieces_.resize(before);
    return false;
  }

  // Returns the parts of a polygon inside and outside a wall.
  static std::pair<Polygon, Polygon> cut(const Polygon& polygon, const WalledFace& face, std::size_t wall) {
    Polygon inside, outside;
    double at_p = face.beyond_wall(wall, polygon[0]);
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const glm::dvec3 &p = polygon[i], &q = polygon[i + 1 == polygon.size() ? 0 : i + 1];
      const double at_q = face.beyond_wall(wall, q);
      if (at_p <= 0.0) inside.add(p);
      if (at_p >= 0.0) outside.add(p);
      if ((at_p > 0.0 && at_q < 0.0) || (at_p < 0.0 && at_q > 0.0)) {
        const glm::dvec3 crossing = p + at_p / (at_p - at_q) * (q - p);
        inside.add(crossing);
        outside.add(crossing);
      }
      at_p = at_q;
    }
    return {inside, outside};
  }

  // Halves triangles, and cuts other polygons into triangles.
  void divide(const Polygon& p, const glm::dvec3& middle) {
    if (p.size() > 3) {
      for (std::size_t i = 0; i < p.size(); ++i) add_triangle(p[i], p[i + 1 == p.size() ? 0 : i + 1], middle);
      return;
    }
    std::size_t longest = 0;  // the side from this corner
    for (std::size_t i = 1; i < 3; ++i)
      if (squared_length(p[(i + 1) % 3] - p[i]) > squared_length(p[(longest + 1) % 3] - p[longest])) longest = i;
    const glm::dvec3 &from = p[longest], &to = p[(longest + 1) % 3], &beside = p[(longest + 2) % 3];
    add_triangle(from, 0.5 * (from + to), beside);
    add_triangle(0.5 * (from + to), to, beside);
  }
  void add_triangle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    Piece& piece = pieces_.emplace_back();
    for (const glm::dvec3& p : {a, b, c}) piece.polygon.add(p);
    piece.near = near_;
  }

  const SurfaceTree& to_;
  double limit_, limit2_;
  int most_pieces_;
  std::uint32_t near_ = no_id;  // the face that was found last
  std::vector<Piece> pieces_;
};

}  // namespace

SurfaceTree::SurfaceTree(const SurfaceView& surface) : surface_(surface) {
  levels_.emplace_back((surface.faces.size() + fan_out - 1) / fan_out, no_box);
  for (std::size_t f = 0; f < surface.faces.size(); ++f)
    for (int k = 0; k < 3; ++k) {
      const glm::vec3& p = surface.positions[surface.faces[f][k]];
      unite(levels_[0][f / fan_out], p, p);
    }
  while (levels_.back().size() > 1) {
    const std::vector<Box>& below = levels_.back();
    std::vector<Box> above((below.size() + fan_out - 1) / fan_out, no_box);
    for (std::size_t i = 0; i < below.size(); ++i) unite(above[i / fan_out], below[i].min, below[i].max);
    levels_.push_back(std::move(above));
  }
  find_neighbours();
}

void SurfaceTree::find_neighbours() {
  const std::span<const Triangle> faces = surface_.faces;
  std::vector<std::uint32_t> first(surface_.positions.size() + 2, 0), faces_at(3 * faces.size());
  for (const Triangle& face : faces)
    for (int k = 0; k < 3; ++k) ++first[face[k] + 2];
  std::partial_sum(first.begin(), first.end(), first.begin());
  for (std::uint32_t f = 0; f < faces.size(); ++f)
    for (int k = 0; k < 3; ++k) faces_at[first[faces[f][k] + 1]++] = f;
  neighbours_.assign(faces.size(), {no_id, no_id, no_id});
  for (std::uint32_t f = 0; f < faces.size(); ++f)
    for (int k = 0; k < 3; ++k) {
      const VertexId from = faces[f][k], to = faces[f][(k + 1) % 3];
      const auto begin = faces_at.begin() + first[from], end = faces_at.begin() + first[from + 1];
      const auto found = std::find_if(begin, std::min(end, begin + most_at_vertex), [&](std::uint32_t g) {
        const Triangle& t = faces[g];
        return g != f && (t.x == to || t.y == to || t.z == to);
      });
      if (found != std::min(end, begin + most_at_vertex)) neighbours_[f][k] = *found;
    }
}

double SurfaceTree::distance2(std::uint32_t face, const glm::dvec3& p) const {
  const Triangle& t = surface_.faces[face];
  return nearest_point(p, surface_.positions[t.x], surface_.positions[t.y], surface_.positions[t.z]).distance2;
}

SurfaceTree::Found SurfaceTree::nearest(const glm::dvec3& p, double enough2, std::uint32_t hint) const {
  struct Entry {
    double distance2 = 0.0;
    std::size_t level = 0, index = 0;
  };
  Found best;
  if (hint != no_id) best = {hint, distance2(hint, p)};
  std::array<Entry, 64> stack;  // a node leaves fan_out - 1 entries, and 2^32 faces have 16 levels
  std::size_t size = 0;
  const auto push = [&](std::size_t level, std::size_t index) {
    const double lower = distance2_to(levels_[level][index], p);
    if (lower < best.distance2) stack[size++] = {lower, level, index};
  };
  push(levels_.size() - 1, 0);
  while (size > 0 && best.distance2 > enough2) {
    const Entry entry = stack[--size];
    if (!(entry.distance2 < best.distance2)) continue;
    const std::size_t first = entry.index * fan_out;
    if (entry.level == 0) {
      const std::size_t end = std::min(first + fan_out, surface_.faces.size());
      for (std::size_t f = first; f < end; ++f)
        if (const double d2 = distance2(static_cast<std::uint32_t>(f), p); d2 < best.distance2)
          best = {static_cast<std::uint32_t>(f), d2};
      continue;
    }
    const std::size_t before = size, end = std::min(first + fan_out, levels_[entry.level - 1].size());
    for (std::size_t i = first; i < end; ++i) push(entry.level - 1, i);
    std::sort(stack.begin() + static_cast<std::ptrdiff_t>(before), stack.begin() + static_cast<std::ptrdiff_t>(size),
              [](const Entry& a, const Entry& b) { return a.distance2 > b.distance2; });
  }
  return best;
}

std::optional<std::vector<FarFace>> faces_beyond(double limit, std::size_t most, const SurfaceView& from,
                                                 const SurfaceTree& to, unsigned threads) {
  constexpr std::size_t part_size = 256;
  std::vector<std::vector<FarFace>> parts((from.faces.size() + part_size - 1) / part_size);
  std::atomic<std::size_t> count = 0;
  for_each_task(parts.size(), threads, [&](std::size_t part) {
    FaceMeasurer measurer(to, limit);
    const std::size_t end = std::min((part + 1) * part_size, from.faces.size());
    for (std::size_t f = part * part_size; f < end && count <= most; ++f) {
      const Triangle& t = from.faces[f];
      const auto near = measurer.beyond(from.positions[t.x], from.positions[t.y], from.positions[t.z]);
      if (!near) continue;
      parts[part].push_back({static_cast<std::uint32_t>(f), *near});
      ++count;
    }
  });
  if (count > most) return std::nullopt;
  std::vector<FarFace> result;
  for (const std::vector<FarFace>& part : parts) result.insert(result.end(), part.begin(), part.end());
  return result;
}

double limit_of(const SurfaceView& from, std::span<const DoubtfulFace> doubtful, const SurfaceTree& to, double limit,
                double most) {
  constexpr int most_pieces = 256;  // what needs more is taken for far, for now
  FaceMeasurer measurer(to, limit, most_pieces);
  for (const DoubtfulFace& d : doubtful) {
    const Triangle& t = from.faces[d.face];
    while (limit < std::min(d.bound, most) &&
           measurer.beyond(from.positions[t.x], from.positions[t.y], from.positions[t.z]))
      measurer.set_limit(limit *= 1.1);
    if (limit >= most) return most;
  }
  return limit;
}

double farthest_vertex(const SurfaceView& from, const SurfaceTree& to, unsigned threads) {
  std::vector<std::uint8_t> is_used(from.positions.size(), 0);
  for (const Triangle& face : from.faces)
    for (int k = 0; k < 3; ++k) is_used[face[k]] = 1;
  std::vector<double> farthest2((is_used.size() + range_size - 1) / range_size, 0.0);
  for_each_range(is_used.size(), threads, [&](std::size_t begin, std::size_t end) {
    double& most = farthest2[begin / range_size];
    SurfaceTree::Found near;
    for (std::size_t v = begin; v < end; ++v) {
      if (is_used[v] == 0) continue;
      near = to.nearest(from.positions[v], most, near.face);  // what is no farther than the farthest does not count
      most = std::max(most, near.distance2);
    }
  });
  return std::sqrt(*std::max_element(farthest2.begin(), farthest2.end()));
}

}  // namespace occlod
