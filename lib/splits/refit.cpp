#include "splits/refit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

#include "base/threads.h"
#include "splits/refit_points.h"

namespace occlod {
namespace {

// Numbers the vertices that reduced faces use, and lists the faces at each.
class ReducedMesh {
 public:
  explicit ReducedMesh(const Reduction& reduction);

  [[nodiscard]] std::size_t size() const { return vertices_.size(); }
  [[nodiscard]] VertexId vertex(std::uint32_t i) const { return vertices_[i]; }
  // Returns the number of an input vertex, no_id when no reduced face uses it.
  [[nodiscard]] std::uint32_t number(VertexId v) const { return number_[v]; }
  [[nodiscard]] const std::vector<Triangle>& faces() const { return faces_; }  // of numbers
  [[nodiscard]] std::span<const std::uint32_t> faces_at(std::uint32_t i) const {
    return std::span(faces_at_).subspan(first_[i], first_[i + 1] - first_[i]);
  }
  [[nodiscard]] std::uint32_t first_face_at(std::uint32_t i) const { return first_[i]; }

 private:
  std::vector<std::uint32_t> number_;
  std::vector<VertexId> vertices_;
  std::vector<Triangle> faces_;
  std::vector<std::uint32_t> first_, faces_at_;
};

ReducedMesh::ReducedMesh(const Reduction& reduction) : number_(reduction.positions.size(), no_id) {
  faces_.reserve(reduction.reduced.size());
  for (Triangle face : reduction.reduced) {
    for (int k = 0; k < 3; ++k) {
      std::uint32_t& number = number_[face[k]];
      if (number == no_id) {
        number = static_cast<std::uint32_t>(vertices_.size());
        vertices_.push_back(face[k]);
      }
      face[k] = number;
    }
    faces_.push_back(face);
  }
  first_.assign(size() + 1, 0);
  for (const Triangle& face : faces_)
    for (int k = 0; k < 3; ++k) ++first_[face[k] + 1];
  for (std::size_t i = 0; i < size(); ++i) first_[i + 1] += first_[i];
  faces_at_.resize(3 * faces_.size());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::uint32_t f = 0; f < faces_.size(); ++f)
    for (int k = 0; k < 3; ++k) faces_at_[next[faces_[f][k]]++] = f;
}

using Positions = std::vector<glm::dvec3>;

glm::dvec3 twice_area(const Positions& at, const Triangle& face) {
  return glm::cross(at[face.y] - at[face.x], at[face.z] - at[face.x]);
}

// Marks the vertices on edges that do not lie between exactly two faces.
std::vector<std::uint8_t> on_borders(const ReducedMesh& mesh) {
  std::vector<std::uint8_t> result(mesh.size(), 0);
  for (std::uint32_t i = 0; i < mesh.size(); ++i) {
    // Each face at i gives one edge that leaves i and one that comes back; within a surface they pair up.
    const auto faces = mesh.faces_at(i);
    const auto count = [&](std::uint32_t other) {
      return std::count_if(faces.begin(), faces.end(), [&](std::uint32_t f) {
        const Triangle& t = mesh.faces()[f];
        return t.x == other || t.y == other || t.z == other;
      });
    };
    const bool inside = std::all_of(faces.begin(), faces.end(), [&](std::uint32_t f) {
      const Triangle& t = mesh.faces()[f];
      return (t.x == i || count(t.x) == 2) && (t.y == i || count(t.y) == 2) && (t.z == i || count(t.z) == 2);
    });
    result[i] = inside ? 0 : 1;
  }
  return result;
}

class Refit {
 public:
  Refit(const Reduction& reduction, const RefitRules& rules, unsigned threads)
      : reduction_(reduction), rules_(rules), mesh_(reduction), threads_(threads), held_(on_borders(mesh_)) {
    for (std::uint32_t i = 0; i < mesh_.size(); ++i) {
      if (!rules.held.empty() && rules.held[mesh_.vertex(i)] != 0) held_[i] = 1;
      at_.emplace_back(scaled(mesh_.vertex(i)));
    }
    start_ = at_;
  }

  std::vector<glm::vec3> run() {
    Positions minima = at_;
    for (std::uint32_t i = 0; i < mesh_.size(); ++i) minima[i] += reduction_.minima[mesh_.vertex(i)];
    move_to(std::move(minima));
    move_to(least_squares());
    if (rules_.keeps_apart || rules_.lattice_step > 0.0F || rules_.least_step > 0.0F) settle();
    std::vector<glm::vec3> result(reduction_.positions.begin(), reduction_.positions.end());
    for (std::uint32_t i = 0; i < mesh_.size(); ++i)
      if (held_[i] == 0 && at_[i] != start_[i]) result[mesh_.vertex(i)] = in_object_space(at_[i]);
    return result;
  }

 private:
  // The sum over the faces at an input vertex of their normals, twice as long as their areas, and of these lengths.
  struct VertexNormal {
    glm::vec3 sum{0.0F};
    float length = 0.0F;
  };
  // Lists for each vertex of the reduced mesh the points of the input that went into it: below the number of the
  // input's faces, middles of faces; from there, vertices.
  struct PointLists {
    std::vector<std::uint32_t> first, points;
  };

  [[nodiscard]] glm::vec3 scaled(VertexId v) const { return reduction_.positions[v] * reduction_.scale; }
  [[nodiscard]] glm::vec3 in_object_space(const glm::dvec3& p) const {
    return glm::vec3(p / static_cast<double>(reduction_.scale));
  }
  [[nodiscard]] PointLists point_lists() const;
  [[nodiscard]] std::vector<VertexNormal> vertex_normals() const;
  [[nodiscard]] FacePlane plane_at(std::uint32_t i, const Triangle& face) const;
  [[nodiscard]] std::vector<FaceSums> face_sums() const;
  [[nodiscard]] Positions least_squares() const;
  void move_to(Positions wanted);
  void keep_along_normals(Positions& wanted) const;
  void limit_steps(Positions& wanted) const;
  void settle();
  void keep_apart(Positions& wanted) const;
  bool take_back_turned(Positions& wanted) const;

  const Reduction& reduction_;
  const RefitRules& rules_;
  ReducedMesh mesh_;
  unsigned threads_;
  std::vector<std::uint8_t> held_;
  Positions start_;  // before all moves; this and all other lengths are scaled
  Positions at_;
};

Refit::PointLists Refit::point_lists() const {
  const std::size_t face_count = reduction_.faces.size(), vertex_count = reduction_.positions.size();
  std::vector<std::uint32_t> into(vertex_count);
  for_each_id(vertex_count, threads_, [&](VertexId v) { into[v] = mesh_.number(reduction_.target[v]); });
  std::vector<std::uint32_t> into_of_face(face_count);
  PointLists result;
  result.first.assign(mesh_.size() + 2, 0);
  for (std::size_t f = 0; f < face_count; ++f) {
    const Triangle& t = reduction_.faces[f];
    into_of_face[f] = into[t.x] != no_id ? into[t.x] : into[t.y] != no_id ? into[t.y] : into[t.z];
    if (into_of_face[f] != no_id) ++result.first[into_of_face[f] + 2];
  }
  for (const std::uint32_t i : into)
    if (i != no_id) ++result.first[i + 2];
  for (std::size_t i = 2; i < result.first.size(); ++i) result.first[i] += result.first[i - 1];
  result.points.resize(result.first.back());
  const auto add = [&](std::uint32_t i, std::size_t point) {
    if (i != no_id) result.points[result.first[i + 1]++] = static_cast<std::uint32_t>(point);
  };
  for (std::size_t f = 0; f < face_count; ++f) add(into_of_face[f], f);
  for (std::size_t v = 0; v < vertex_count; ++v) add(into[v], face_count + v);
  return result;
}

std::vector<Refit::VertexNormal> Refit::vertex_normals() const {
  std::vector<VertexNormal> result(reduction_.positions.size());
  for (const Triangle& t : reduction_.faces) {
    const glm::vec3 a = scaled(t.x), normal = glm::cross(scaled(t.y) - a, scaled(t.z) - a);
    const float length = glm::length(normal);
    for (int k = 0; k < 3; ++k) {
      result[t[k]].sum += normal;
      result[t[k]].length += length;
    }
  }
  return result;
}

// Assigns points of the input, with their shares of its area, to the nearest reduced faces: the middles of faces and
// the vertices, as integrates squares exactly over a face (with 3/4 and three times 1/12). Points over none of the
// faces at the vertex into which they went count for nothing.
std::vector<FaceSums> Refit::face_sums() const {
  const PointLists lists = point_lists();
  const std::vector<VertexNormal> normals = vertex_normals();
  const std::size_t face_count = reduction_.faces.size();
  std::vector<FaceSums> at_corners(3 * mesh_.faces().size());  // by vertex, as faces_at() lists them
  struct Worker {
    RefitPoints points;
    std::vector<FacePlane> planes;
  };
  const auto gather = [&](Worker& worker, std::uint32_t i) {
    const auto sums = std::span(at_corners).subspan(mesh_.first_face_at(i), mesh_.faces_at(i).size());
    worker.planes.clear();
    for (const std::uint32_t f : mesh_.faces_at(i)) worker.planes.push_back(plane_at(i, mesh_.faces()[f]));
    for (std::uint32_t k = lists.first[i]; k < lists.first[i + 1]; ++k) {
      const std::uint32_t point = lists.points[k];
      if (point < face_count) {
        const Triangle& t = reduction_.faces[point];
        const glm::vec3 a = scaled(t.x), ab = scaled(t.y) - a, ac = scaled(t.z) - a, normal = glm::cross(ab, ac);
        const glm::vec3 from_a = (ab + ac) / 3.0F;
        worker.points.add(glm::vec3(glm::dvec3(a) - at_[i]) + from_a, normal, 0.75F * glm::length(normal));
      } else {
        const VertexId v = point - static_cast<std::uint32_t>(face_count);
        worker.points.add(glm::vec3(glm::dvec3(scaled(v)) - at_[i]), normals[v].sum, normals[v].length / 12.0F);
      }
      if (worker.points.size() == RefitPoints::capacity) worker.points.settle(worker.planes, sums);
    }
    worker.points.settle(worker.planes, sums);
  };
  constexpr std::size_t step = 64;  // vertices a task
  for_each_task((mesh_.size() + step - 1) / step, threads_, [] { return Worker(); },
                [&](Worker& worker, std::size_t task) {
                  for (std::size_t i = task * step; i < std::min((task + 1) * step, mesh_.size()); ++i)
                    gather(worker, static_cast<std::uint32_t>(i));
                },
                [] {});
  std::vector<FaceSums> sums(mesh_.faces().size());
  for (std::uint32_t i = 0; i < mesh_.size(); ++i)
    for (std::size_t slot = 0; slot < mesh_.faces_at(i).size(); ++slot)
      sums[mesh_.faces_at(i)[slot]].add(at_corners[mesh_.first_face_at(i) + slot]);
  return sums;
}

FacePlane Refit::plane_at(std::uint32_t i, const Triangle& face) const {
  const glm::dvec3 ab = at_[face.y] - at_[face.x], ac = at_[face.z] - at_[face.x], twice_area = glm::cross(ab, ac);
  const double length2 = glm::dot(twice_area, twice_area);
  if (!(length2 > 0.0)) return {};
  return {glm::vec3(twice_area / std::sqrt(length2)), glm::vec3(glm::cross(ac, twice_area) / length2),
          glm::vec3(glm::cross(twice_area, ab) / length2), face.y == i ? 1.0F : 0.0F, face.z == i ? 1.0F : 0.0F};
}

// Solves for the steps of all vertices by a few rounds of conjugate gradients with the diagonal as preconditioner.
Positions Refit::least_squares() const {
  constexpr int rounds = 4;
  constexpr double hold = 1e-3;  // of a vertex's own weight, and of the mean where it has little
  const std::vector<FaceSums> sums = face_sums();
  const std::vector<Triangle>& faces = mesh_.faces();
  const std::size_t n = mesh_.size();
  std::vector<double> diagonal(n, 0.0);
  Positions rest(n, glm::dvec3(0.0));  // right side minus matrix times step
  for (std::size_t f = 0; f < faces.size(); ++f) {
    diagonal[faces[f].x] += sums[f].squares[0];
    diagonal[faces[f].y] += sums[f].squares[3];
    diagonal[faces[f].z] += sums[f].squares[5];
    const glm::dvec3 twice = twice_area(at_, faces[f]);
    const double length = glm::length(twice);
    if (length > 0.0)
      for (int k = 0; k < 3; ++k) rest[faces[f][k]] += sums[f].heights[static_cast<std::size_t>(k)] / length * twice;
  }
  double mean = 0.0;
  for (const double d : diagonal) mean += d / static_cast<double>(n);
  std::vector<double> held_by(n);
  for (std::size_t i = 0; i < n; ++i) held_by[i] = hold * std::max(diagonal[i], 1e-3 * mean);
  const auto is_free = [&](std::size_t i) { return held_[i] == 0 && diagonal[i] + held_by[i] > 0.0; };
  for (std::size_t i = 0; i < n; ++i)
    if (!is_free(i)) rest[i] = glm::dvec3(0.0);

  const auto times_matrix = [&](const Positions& x) {
    Positions y(n);
    for (std::size_t i = 0; i < n; ++i) y[i] = held_by[i] * x[i];
    for (std::size_t f = 0; f < faces.size(); ++f) {
      const Triangle& t = faces[f];
      const std::array<double, 6>& m = sums[f].squares;
      y[t.x] += m[0] * x[t.x] + m[1] * x[t.y] + m[2] * x[t.z];
      y[t.y] += m[1] * x[t.x] + m[3] * x[t.y] + m[4] * x[t.z];
      y[t.z] += m[2] * x[t.x] + m[4] * x[t.y] + m[5] * x[t.z];
    }
    for (std::size_t i = 0; i < n; ++i)
      if (!is_free(i)) y[i] = glm::dvec3(0.0);
    return y;
  };
  const auto scaled_rest = [&] {
    Positions z(n, glm::dvec3(0.0));
    for (std::size_t i = 0; i < n; ++i)
      if (is_free(i)) z[i] = rest[i] / (diagonal[i] + held_by[i]);
    return z;
  };
  // One product for each coordinate, because each is a system of its own.
  const auto products = [&](const Positions& a, const Positions& b) {
    glm::dvec3 sum(0.0);
    for (std::size_t i = 0; i < n; ++i) sum += a[i] * b[i];
    return sum;
  };
  const auto ratio = [](const glm::dvec3& a, const glm::dvec3& b) {
    return glm::dvec3(b.x > 0.0 ? a.x / b.x : 0.0, b.y > 0.0 ? a.y / b.y : 0.0, b.z > 0.0 ? a.z / b.z : 0.0);
  };
  Positions step(n, glm::dvec3(0.0)), z = scaled_rest(), direction = z;
  glm::dvec3 rz = products(rest, z);
  for (int round = 0; round < rounds; ++round) {
    const Positions image = times_matrix(direction);
    const glm::dvec3 alpha = ratio(rz, products(direction, image));
    for (std::size_t i = 0; i < n; ++i) {
      step[i] += alpha * direction[i];
      rest[i] -= alpha * image[i];
    }
    z = scaled_rest();
    const glm::dvec3 next = products(rest, z), beta = ratio(next, std::exchange(rz, next));
    for (std::size_t i = 0; i < n; ++i) direction[i] = z[i] + beta * direction[i];
  }
  for (std::size_t i = 0; i < n; ++i) step[i] += at_[i];
  return step;
}

void Refit::move_to(Positions wanted) {
  for (std::uint32_t i = 0; i < mesh_.size(); ++i) {
    const bool is_finite = std::isfinite(wanted[i].x) && std::isfinite(wanted[i].y) && std::isfinite(wanted[i].z);
    if (held_[i] != 0 || !is_finite) wanted[i] = at_[i];
  }
  if (rules_.along_normals) keep_along_normals(wanted);
  limit_steps(wanted);
  while (take_back_turned(wanted)) continue;  // ends: each time at least one vertex more is back
  at_ = std::move(wanted);
}

void Refit::keep_along_normals(Positions& wanted) const {
  for (std::uint32_t i = 0; i < mesh_.size(); ++i) {
    glm::dvec3 normal(0.0);
    for (const std::uint32_t f : mesh_.faces_at(i)) normal += twice_area(at_, mesh_.faces()[f]);
    const double length2 = glm::dot(normal, normal);
    wanted[i] = at_[i] + (length2 > 0.0 ? glm::dot(wanted[i] - at_[i], normal) / length2 : 0.0) * normal;
  }
}

// No vertex moves by more than half of its longest edge.
void Refit::limit_steps(Positions& wanted) const {
  for (std::uint32_t i = 0; i < mesh_.size(); ++i) {
    const glm::dvec3 step = wanted[i] - at_[i];
    const double length2 = glm::dot(step, step);
    if (length2 == 0.0) continue;
    double longest2 = 0.0;
    for (const std::uint32_t f : mesh_.faces_at(i))
      for (int k = 0; k < 3; ++k) {
        const glm::dvec3 edge = at_[mesh_.faces()[f][k]] - at_[i];
        longest2 = std::max(longest2, glm::dot(edge, edge));
      }
    if (length2 > 0.25 * longest2) wanted[i] = at_[i] + std::sqrt(0.25 * longest2 / length2) * step;
  }
}

// Rounds the moves to the rules. Those that are not worth it or not allowed are taken back to where the vertex started.
void Refit::settle() {
  const double scale = reduction_.scale, least = static_cast<double>(rules_.least_step) * scale;
  Positions wanted = at_;
  for (std::uint32_t i = 0; i < mesh_.size(); ++i) {
    glm::dvec3 step = at_[i] - start_[i];
    if (!rules_.most.empty()) {
      const double most = static_cast<double>(rules_.most[mesh_.vertex(i)]) * scale, length = glm::length(step);
      if (length > most) step *= most / length;
    }
    glm::vec3 p = in_object_space(start_[i] + step);
    if (rules_.lattice_step > 0.0F) p = round_to_lattice(p, rules_.lattice_step);
    const bool is_worth = glm::dot(step, step) > least * least;
    const bool is_near = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) <= farthest_coordinate;
    wanted[i] = is_worth && is_near ? glm::dvec3(p) * scale : start_[i];
  }
  if (rules_.keeps_apart) keep_apart(wanted);
  at_ = start_;
  while (take_back_turned(wanted)) continue;
  at_ = std::move(wanted);
}

// Takes back moves to where a vertex of the input is, or another one that moves.
void Refit::keep_apart(Positions& wanted) const {
  using Key = std::array<float, 3>;
  const auto key = [](const glm::vec3& p) { return Key{p.x, p.y, p.z}; };
  std::vector<Key> taken;
  for (const glm::vec3& p : reduction_.positions) taken.push_back(key(p));
  for (std::uint32_t i = 0; i < mesh_.size(); ++i)
    if (wanted[i] != start_[i]) taken.push_back(key(in_object_space(wanted[i])));
  std::sort(taken.begin(), taken.end());
  for (std::uint32_t i = 0; i < mesh_.size(); ++i) {
    if (wanted[i] == start_[i]) continue;
    const auto [first, last] = std::equal_range(taken.begin(), taken.end(), key(in_object_space(wanted[i])));
    if (last - first > 1) wanted[i] = start_[i];
  }
}

// Faces must not turn by more than some 78 degrees from where they were before all moves.
bool Refit::take_back_turned(Positions& wanted) const {
  constexpr double least_cosine = 0.2;
  bool any = false;
  for (const Triangle& face : mesh_.faces()) {
    if (wanted[face.x] == at_[face.x] && wanted[face.y] == at_[face.y] && wanted[face.z] == at_[face.z]) continue;
    const glm::dvec3 before = twice_area(start_, face), after = twice_area(wanted, face);
    if (glm::dot(before, after) > least_cosine * glm::length(before) * glm::length(after)) continue;
    any = true;
    for (int k = 0; k < 3; ++k) wanted[face[k]] = at_[face[k]];
  }
  return any;
}

}  // namespace

std::vector<glm::vec3> refit(const Reduction& reduction, const RefitRules& rules, unsigned threads) {
  return Refit(reduction, rules, threads).run();
}

std::vector<std::uint8_t> on_seams(std::span<const Triangle> faces, std::span<const Triangle> wedges,
                                   std::size_t vertex_count) {
  std::vector<WedgeId> first(vertex_count, no_id);
  std::vector<std::uint8_t> result(vertex_count, 0);
  for (std::size_t t = 0; t < faces.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      WedgeId& wedge = first[faces[t][k]];
      if (wedge == no_id) wedge = wedges[t][k];
      if (wedge != wedges[t][k]) result[faces[t][k]] = 1;
    }
  return result;
}

}  // namespace occlod
