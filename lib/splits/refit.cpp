#include "splits/refit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

#include "base/threads.h"
#include "splits/nearest_point.h"

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

// The symmetric matrix and the right side of a vertex's quadric, relative to the vertex.
struct Quadric {
  double xx = 0.0, xy = 0.0, xz = 0.0, yy = 0.0, yz = 0.0, zz = 0.0;
  glm::dvec3 right{0.0};

  // Adds the plane of a face: `normal` is its unit normal times the root of its weight, at `offset` along it.
  void add(const glm::dvec3& normal, double offset) {
    xx += normal.x * normal.x;
    xy += normal.x * normal.y;
    xz += normal.x * normal.z;
    yy += normal.y * normal.y;
    yz += normal.y * normal.z;
    zz += normal.z * normal.z;
    right += offset * normal;
  }

  // Returns the minimum, held near the vertex where the planes leave it open. 0 without planes.
  [[nodiscard]] glm::dvec3 minimum() const {
    constexpr double hold = 1e-3;  // of the mean of the three weights
    const double extra = hold * (xx + yy + zz) / 3.0;
    const double a = xx + extra, b = yy + extra, c = zz + extra;
    const glm::dvec3 row_x(b * c - yz * yz, xz * yz - xy * c, xy * yz - xz * b);
    const double determinant = a * row_x.x + xy * row_x.y + xz * row_x.z;
    if (!(determinant > 0.0)) return glm::dvec3(0.0);
    const glm::dvec3 row_y(row_x.y, a * c - xz * xz, xy * xz - a * yz), row_z(row_x.z, row_y.z, a * b - xy * xy);
    return glm::dvec3(glm::dot(row_x, right), glm::dot(row_y, right), glm::dot(row_z, right)) / determinant;
  }
};

// The plane of a face: where a point lies over the face, in barycentric coordinates, and how far from it.
struct FacePlane {
  glm::dvec3 origin, normal{0.0}, along_y{0.0}, along_z{0.0};

  FacePlane(const Positions& at, const Triangle& face) : origin(at[face.x]) {
    const glm::dvec3 ab = at[face.y] - origin, ac = at[face.z] - origin, twice_area = glm::cross(ab, ac);
    const double length2 = glm::dot(twice_area, twice_area);
    if (!(length2 > 0.0)) return;
    along_y = glm::cross(ac, twice_area) / length2;
    along_z = glm::cross(twice_area, ab) / length2;
    normal = twice_area / std::sqrt(length2);
  }
};

std::uint32_t heaviest_corner(const Triangle& face, const glm::dvec3& w) {
  return w.x >= w.y && w.x >= w.z ? face.x : w.y >= w.z ? face.y : face.z;
}

class Refit {
 public:
  Refit(const Reduction& reduction, std::span<const std::uint8_t> held, bool along_normals, unsigned threads)
      : reduction_(reduction),
        mesh_(reduction),
        along_normals_(along_normals),
        threads_(threads),
        held_(on_borders(mesh_)) {
    for (std::uint32_t i = 0; i < mesh_.size(); ++i) {
      if (!held.empty() && held[mesh_.vertex(i)] != 0) held_[i] = 1;
      at_.emplace_back(reduction.positions[mesh_.vertex(i)]);
    }
    start_ = at_;
    normals_.resize(reduction.faces.size());
    for_each_range(normals_.size(), threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t f = begin; f < end; ++f) normals_[f] = input_normal(reduction.faces[f]);
    });
  }

  std::vector<glm::vec3> run() {
    move_to(quadric_minima());
    move_to(least_squares());
    std::vector<glm::vec3> result(reduction_.positions.begin(), reduction_.positions.end());
    for (std::uint32_t i = 0; i < mesh_.size(); ++i)
      if (held_[i] == 0) result[mesh_.vertex(i)] = glm::vec3(at_[i]);
    return result;
  }

 private:
  // Each is as sparse as its face: the sums of squared and mixed weights, and of weighted points.
  struct FaceSums {
    std::array<double, 6> squares{};  // xx, xy, xz, yy, yz, zz
    std::array<glm::dvec3, 3> points{};
  };

  [[nodiscard]] Positions quadric_minima() const;
  [[nodiscard]] Positions least_squares() const;
  [[nodiscard]] std::vector<FaceSums> face_sums() const;
  struct Place {
    std::uint32_t face = no_id;
    glm::dvec3 weights{0.0};
  };
  [[nodiscard]] Place place_over(const glm::dvec3& p, const glm::dvec3& normal, std::uint32_t from,
                                 std::span<const FacePlane> planes) const;
  [[nodiscard]] Place nearest_place(const glm::dvec3& p, std::uint32_t from) const;
  struct Sample {
    std::uint32_t face = no_id;
    double weight = 0.0;  // the share of the input's area
    glm::vec3 weights{0.0F}, off{0.0F};
  };
  [[nodiscard]] Sample sample_at(const glm::dvec3& p, const glm::dvec3& normal, double weight, std::uint32_t from,
                                 std::span<const FacePlane> planes) const;
  static void add(const Sample& sample, std::vector<FaceSums>& sums);
  [[nodiscard]] glm::dvec3 input_normal(const Triangle& face) const {
    const glm::dvec3 a(reduction_.positions[face.x]);
    return glm::cross(glm::dvec3(reduction_.positions[face.y]) - a, glm::dvec3(reduction_.positions[face.z]) - a);
  }
  void move_to(Positions wanted);
  void keep_along_normals(Positions& wanted) const;
  void limit_steps(Positions& wanted) const;
  bool take_back_turned(Positions& wanted) const;

  const Reduction& reduction_;
  ReducedMesh mesh_;
  bool along_normals_;
  unsigned threads_;
  std::vector<std::uint8_t> held_;
  Positions normals_;  // of the input's faces, twice as long as their areas
  Positions start_;    // before all moves
  Positions at_;
};

Positions Refit::quadric_minima() const {
  std::vector<Quadric> quadrics(mesh_.size());
  for (std::size_t f = 0; f < normals_.size(); ++f) {
    const double length = glm::length(normals_[f]);
    if (!(length > 0.0)) continue;
    const Triangle& face = reduction_.faces[f];
    const glm::dvec3 a(reduction_.positions[face.x]), weighted = normals_[f] / std::sqrt(2.0 * length);
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t i = mesh_.number(reduction_.target[face[k]]);
      if (i != no_id) quadrics[i].add(weighted, glm::dot(weighted, a - at_[i]));
    }
  }
  Positions result = at_;
  for (std::uint32_t i = 0; i < mesh_.size(); ++i) result[i] += quadrics[i].minimum();
  return result;
}

// Returns the place in the nearest of those faces at a vertex over which a point of a surface with this normal lies, if
// there is such a face.
Refit::Place Refit::place_over(const glm::dvec3& p, const glm::dvec3& normal, std::uint32_t from,
                               std::span<const FacePlane> planes) const {
  Place best;
  double distance = std::numeric_limits<double>::infinity();
  constexpr double least_cosine = 0.7;  // so that points beside a crease go to their own side of it
  for (const std::uint32_t f : mesh_.faces_at(from)) {
    const FacePlane& plane = planes[f];
    const glm::dvec3 off = p - plane.origin;
    const double y = glm::dot(plane.along_y, off), z = glm::dot(plane.along_z, off);
    if (!(y >= 0.0 && z >= 0.0 && y + z <= 1.0) ||
        !(glm::dot(plane.normal, normal) > least_cosine * glm::length(normal)))
      continue;
    const double d = std::abs(glm::dot(plane.normal, off));
    if (!(d < distance)) continue;
    distance = d;
    best = {f, {1.0 - y - z, y, z}};
  }
  return best;
}

// Returns the nearest place among the faces at a vertex and among those at the corner that is nearest to it.
Refit::Place Refit::nearest_place(const glm::dvec3& p, std::uint32_t from) const {
  Place best;
  double distance2 = std::numeric_limits<double>::infinity();
  const auto look_around = [&](std::uint32_t vertex) {
    for (const std::uint32_t f : mesh_.faces_at(vertex)) {
      const Triangle& t = mesh_.faces()[f];
      const NearestPoint found = nearest_point(p, at_[t.x], at_[t.y], at_[t.z]);
      if (!(found.distance2 < distance2)) continue;
      distance2 = found.distance2;
      best = {f, found.weights};
    }
  };
  look_around(from);
  if (best.face == no_id) return best;
  const std::uint32_t nearest = heaviest_corner(mesh_.faces()[best.face], best.weights);
  if (nearest != from) look_around(nearest);
  return best;
}

// Assigns points of the input, with their shares of its area, to the nearest reduced faces: the middles of faces and
// the vertices, as integrates squares exactly over a face (with 3/4 and three times 1/12).
std::vector<Refit::FaceSums> Refit::face_sums() const {
  std::vector<FacePlane> planes;
  planes.reserve(mesh_.faces().size());
  for (const Triangle& face : mesh_.faces()) planes.emplace_back(at_, face);
  std::vector<Sample> samples(reduction_.faces.size());
  for_each_range(samples.size(), threads_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const Triangle& t = reduction_.faces[f];
      std::uint32_t from = no_id;
      for (int k = 0; k < 3 && from == no_id; ++k) from = mesh_.number(reduction_.target[t[k]]);
      const glm::dvec3 middle = (glm::dvec3(reduction_.positions[t.x]) + glm::dvec3(reduction_.positions[t.y]) +
                                 glm::dvec3(reduction_.positions[t.z])) /
                                3.0;
      samples[f] = sample_at(middle, normals_[f], 0.75 * 0.5 * glm::length(normals_[f]), from, planes);
    }
  });
  std::vector<FaceSums> sums(mesh_.faces().size());
  for (const Sample& sample : samples) add(sample, sums);

  Positions normals(reduction_.positions.size(), glm::dvec3(0.0));
  std::vector<double> areas(normals.size(), 0.0);
  for (std::size_t f = 0; f < normals_.size(); ++f)
    for (int k = 0; k < 3; ++k) {
      normals[reduction_.faces[f][k]] += normals_[f];
      areas[reduction_.faces[f][k]] += samples[f].weight / 0.75;
    }
  samples.resize(normals.size());
  for_each_range(samples.size(), threads_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v)
      samples[v] = sample_at(glm::dvec3(reduction_.positions[v]), normals[v], areas[v] / 12.0,
                             mesh_.number(reduction_.target[v]), planes);
  });
  for (const Sample& sample : samples) add(sample, sums);
  return sums;
}

// Returns where a point of the input lies on the reduced faces around `from`, and what it adds to their sums.
Refit::Sample Refit::sample_at(const glm::dvec3& p, const glm::dvec3& normal, double weight, std::uint32_t from,
                               std::span<const FacePlane> planes) const {
  if (from == no_id || !(weight > 0.0)) return {.weight = weight};
  Place place = place_over(p, normal, from, planes);
  if (place.face == no_id) place = nearest_place(p, from);
  if (place.face == no_id) return {.weight = weight};
  const Triangle& t = mesh_.faces()[place.face];
  const glm::dvec3& w = place.weights;
  const glm::dvec3 off = p - (w.x * at_[t.x] + w.y * at_[t.y] + w.z * at_[t.z]);
  // A point beyond the border of the faces that were tried says nothing about how to move them along themselves.
  const double along = glm::dot(planes[place.face].normal, off);
  const bool is_over = along * along >= 0.5 * squared_length(off);
  return {place.face, weight, glm::vec3(w), is_over ? glm::vec3(off) : glm::vec3(0.0F)};
}

void Refit::add(const Sample& sample, std::vector<FaceSums>& sums) {
  if (sample.face == no_id) return;
  FaceSums& sum = sums[sample.face];
  const glm::dvec3 w(sample.weights), weighted = sample.weight * w, off(sample.off);
  const std::array<double, 6> squares = {weighted.x * w.x, weighted.x * w.y, weighted.x * w.z,
                                         weighted.y * w.y, weighted.y * w.z, weighted.z * w.z};
  for (std::size_t k = 0; k < 6; ++k) sum.squares[k] += squares[k];
  for (int k = 0; k < 3; ++k) sum.points[static_cast<std::size_t>(k)] += weighted[k] * off;
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
    for (int k = 0; k < 3; ++k) rest[faces[f][k]] += sums[f].points[static_cast<std::size_t>(k)];
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
  if (along_normals_) keep_along_normals(wanted);
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

std::vector<glm::vec3> refit(const Reduction& reduction, std::span<const std::uint8_t> held, bool along_normals,
                             unsigned threads) {
  return Refit(reduction, held, along_normals, threads).run();
}

}  // namespace occlod
