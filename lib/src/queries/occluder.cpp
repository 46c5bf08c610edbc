#include "queries/occluder.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "math/inverse_power_of_two.h"

namespace occlod {
namespace {

constexpr float round_up = 1.0F + 1e-5F;

// How far the surface around a vertex may be from the input, given the first split of its chain in the forest: what the
// first that is not applied promises, since errors are saturated along the chain.
float chain_error(const Cut& cut, SplitId first) {
  const Hierarchy& hierarchy = cut.hierarchy();
  for (SplitId s = first; s != no_id; s = hierarchy.node(s).child_u) {
    hierarchy.require(s);
    if (!cut.applied(s)) return hierarchy.node(s).guaranteed_error;
  }
  return 0.0F;
}

// A face in a unit near its size.
struct ScaledFace {
  ScaledFace(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c)
      : unit(inverse_power_of_two(std::max(largest_coordinate(b - a), largest_coordinate(c - a)))),
        ab(unit * (b - a)),
        bc(unit * (c - b)),
        ac(unit * (c - a)),
        normal(glm::cross(ab, ac)) {}

  // Of the plane through one of its corners; `to_point`, from there, is of any size.
  [[nodiscard]] float side(const glm::vec3& to_point) const {
    return glm::dot(normal, inverse_power_of_two(to_point) * to_point);
  }

  float unit;  // times lengths
  glm::vec3 ab, bc, ac;
  glm::vec3 normal;  // twice its area long
};

// Where a face of a solid can be moved by more than half of its smallest height it is no use as an occluder: it may be
// long and the solid thin all the same. The flattest closed section over a face of width w that is not a sheet, a
// regular triangle, is 0.87 w deep, and moved farther a face comes out at the back and hides what is seen beside it.
bool is_thick(const ScaledFace& face, float error) {
  const float longest = std::max({glm::length(face.ab), glm::length(face.bc), glm::length(face.ac)});
  return 2.0F * (face.unit * error) * longest < glm::length(face.normal);
}

// What shows its back is not drawn, and so hides nothing; of a closed surface it lies behind what shows its front.
// Faces that are no numbers or too small to tell stay.
void drop_back_faces(std::span<const glm::vec3> positions, const glm::vec3& eye, std::vector<Triangle>& triangles) {
  std::size_t kept = 0;
  for (const Triangle& t : triangles) {
    const glm::vec3 &a = positions[t.x], &b = positions[t.y], &c = positions[t.z];
    const bool is_back = glm::dot(glm::cross(b - a, c - a), eye - a) < 0.0F;
    triangles[kept] = t;
    kept += is_back ? 0 : 1;
  }
  triangles.resize(kept);
}

// Away from the eye, so far that the true surface, which is no farther from the face than `error`, is in front of it.
glm::vec3 push_of(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, float error, const glm::vec3& eye) {
  const ScaledFace face(a, b, c);
  return face.normal * (std::copysign(error * round_up, face.side(a - eye)) / glm::length(face.normal));
}

}  // namespace

std::span<const OccluderPart> Occluder::build(std::span<const RefineObject> objects, CutSet& cuts,
                                              std::span<const ObjectView> views, OccluderMode mode) {
  parts_.resize(cuts.size());
  result_.clear();
  for (std::uint32_t i = 0; i < cuts.size(); ++i) {
    Part& part = parts_[i];
    std::span<const glm::vec3> positions = cuts[i].hierarchy().positions();
    if (mode == OccluderMode::paper) {
      cuts.active_triangles(i, part.triangles, false);
      if (!objects[i].two_sided) drop_back_faces(positions, views[i].eye(), part.triangles);
    } else {
      cuts.active_triangles(i, part.cut, true);
      find_errors(cuts[i]);
      find_faces(cuts[i], part.cut, objects[i].two_sided, views[i].eye());
      add_moved_back(cuts[i], views[i].eye(), part);
      positions = part.positions;
    }
    result_.push_back({i, positions, part.triangles});
  }
  return result_;
}

// Of a solid, front faces that can be moved inwards; of sheets, which have two sides and no inside, faces far from any
// border.
void Occluder::find_faces(const Cut& cut, std::span<const Triangle> triangles, bool two_sided, const glm::vec3& eye) {
  const std::span<const glm::vec3> positions = cut.hierarchy().positions();
  faces_.clear();
  for (const Triangle& t : triangles) {
    const glm::vec3 &a = positions[t.x], &b = positions[t.y], &c = positions[t.z];
    const ScaledFace face(a, b, c);
    const float facing = face.side(eye - a);
    const float error = error_of(cut, t);
    if (two_sided ? facing != 0.0F : facing > 0.0F && is_thick(face, error)) faces_.push_back({t, error});
  }
  if (!two_sided) return;
  const std::span<const std::uint8_t> kept = erosion_.kept(faces_, positions, eye);
  std::size_t f = 0;
  std::erase_if(faces_, [&](const SheetFace&) { return kept[f++] == 0; });
}

// Each face moves by itself, so they share no vertices.
void Occluder::add_moved_back(const Cut& cut, const glm::vec3& eye, Part& part) const {
  const std::span<const glm::vec3> positions = cut.hierarchy().positions();
  part.positions.clear();
  part.triangles.clear();
  for (const SheetFace& face : faces_) {
    const Triangle& t = face.corners;
    const glm::vec3 &a = positions[t.x], &b = positions[t.y], &c = positions[t.z];
    const glm::vec3 back = push_of(a, b, c, face.error, eye);
    const auto first = static_cast<VertexId>(part.positions.size());
    part.positions.insert(part.positions.end(), {a + back, b + back, c + back});
    part.triangles.emplace_back(first, first + 1, first + 2);
  }
}

void Occluder::find_errors(const Cut& cut) {
  const Hierarchy& hierarchy = cut.hierarchy();
  base_roots_.assign(hierarchy.base_vertex_count(), no_id);
  for (const SplitId root : hierarchy.data().roots) {
    hierarchy.require(root);
    const VertexId u = hierarchy.star(root).parent_vertex();
    if (u < base_roots_.size()) base_roots_[u] = root;
  }
  errors_.clear();
  for (const SplitId root : base_roots_) errors_.push_back(chain_error(cut, root));
  for (const SplitId s : cut.applied_splits()) errors_.push_back(chain_error(cut, hierarchy.node(s).child_v));
}

// A face that is not of the input was made by a collapse into one of its corners, and is no farther from the input than
// that collapse promises.
float Occluder::error_of(const Cut& cut, const Triangle& t) const {
  const std::size_t base = cut.hierarchy().base_vertex_count();
  const std::span<const SplitId> applied = cut.applied_splits();
  float error = 0.0F;
  for (int k = 0; k < 3; ++k) {
    const VertexId v = t[k];
    const std::size_t place =
        v < base ? v
                 : base + static_cast<std::size_t>(std::lower_bound(applied.begin(), applied.end(), v - base) -
                                                   applied.begin());
    error = std::max(error, errors_[place]);
  }
  return error;
}

}  // namespace occlod
