#include "mesh/stream_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "base/memory.h"
#include "mesh/mesh_files.h"
#include "mesh/wedges.h"
#include "occlod/mesh.h"

namespace occlod {

TriangleMesh PieceCutter::cut(std::size_t begin, std::size_t end) {
  constexpr std::size_t triangles_between_looks = 1024;  // between two calls of make_room()
  TriangleMesh piece;
  wedges_.clear();
  for (std::size_t t = begin; t < end; ++t) {
    if (t % triangles_between_looks == 0) make_room();
    Triangle triangle = mesh_.triangles[t];
    for (int k = 0; k < 3; ++k) {
      VertexId& local = local_[triangle[k]];
      if (local == no_id) {
        local = static_cast<VertexId>(wedges_.size());
        wedges_.push_back(triangle[k]);
      }
      triangle[k] = local;
    }
    piece.triangles.push_back(triangle);
    if (!mesh_.triangle_materials.empty()) piece.triangle_materials.push_back(mesh_.triangle_materials[t]);
    if (!mesh_.triangle_features.empty()) piece.triangle_features.push_back(mesh_.triangle_features[t]);
  }
  const auto gather = [&](const auto& from, auto& to) {
    if (from.empty()) return;
    for (const WedgeId wedge : wedges_) {
      if (to.size() % triangles_between_looks == 0) make_room();
      to.push_back(from[wedge]);
    }
  };
  gather(mesh_.positions, piece.positions);
  gather(mesh_.normals, piece.normals);
  gather(mesh_.colors, piece.colors);
  gather(mesh_.texture_coordinates, piece.texture_coordinates);
  piece.texture_origin = mesh_.texture_origin;
  piece.origin = mesh_.origin;
  piece.up = mesh_.up;
  for (const WedgeId wedge : wedges_) local_[wedge] = no_id;
  return piece;
}

namespace {

// Calls what(i) for all i below `count`, and make_room() from time to time.
template <class What>
void for_each_index(std::size_t count, const What& what) {
  constexpr std::size_t between_looks = 1024;
  for (std::size_t i = 0; i < count; ++i) {
    if (i % between_looks == 0) make_room();
    what(i);
  }
}

// A value at each of some positions; +0 and -0 are equal.
template <class Value>
class ValuesAtPlaces {
 public:
  void add_place(const glm::vec3& p) { places_.push_back(key_of(p)); }
  // Call after all places have been added; all values are then `value`.
  void begin(const Value& value) {
    std::sort(places_.begin(), places_.end());
    places_.erase(std::unique(places_.begin(), places_.end()), places_.end());
    values_.assign(places_.size(), value);
  }
  // Returns the value at a place, null where none has been added.
  [[nodiscard]] Value* find(const glm::vec3& p) {
    const Key key = key_of(p);
    const auto found = std::lower_bound(places_.begin(), places_.end(), key);
    if (found == places_.end() || *found != key) return nullptr;
    return &values_[static_cast<std::size_t>(found - places_.begin())];
  }
  [[nodiscard]] const LargeVector<Value>& values() const { return values_; }

 private:
  using Key = std::array<float, 3>;
  static Key key_of(const glm::vec3& p) { return {p.x + 0.0F, p.y + 0.0F, p.z + 0.0F}; }

  LargeVector<Key> places_;
  LargeVector<Value> values_;
};

ScratchSoup parse(const std::filesystem::path& path, const FileErrors& errors,
                  const std::function<void(double)>& progress) {
  const bool is_ply = format_of(path, errors) == MeshFormat::ply;
  InputBytes input(path, errors, progress);
  return is_ply ? parse_ply<InScratch>(input, errors) : parse_obj<InScratch>(input, errors);
}

}  // namespace

bool is_streamable(const std::filesystem::path& path) {
  const MeshFormat format = format_of(path, FileErrors(path));
  return format == MeshFormat::ply || format == MeshFormat::obj;
}

StreamedMesh::StreamedMesh(const std::filesystem::path& path, const std::function<void(double)>& progress) {
  const FileErrors errors(path);
  soup_ = parse(path, errors, progress);
  triangles_ = soup_.take_triangles(report_, errors);
  is_used_.resize(soup_.positions.size());
  for_each_index(triangles_.size(), [&](std::size_t t) {
    for (int k = 0; k < 3; ++k) is_used_[triangles_[t][k]] = true;
  });
  check_distances(errors);
  drop_repeated_corners(errors);
  count_unused_vertices();
  repair_texture_coordinates();
  repair_normals();
  is_used_ = {};
}

void StreamedMesh::visit(std::size_t most, const std::function<void(const TriangleMesh& piece)>& take) const {
  PieceCutter cutter({.positions = soup_.positions,
                      .normals = soup_.normals,
                      .colors = soup_.colors,
                      .texture_coordinates = soup_.texture_coordinates,
                      .triangles = triangles_,
                      .triangle_materials = soup_.polygon_materials,
                      .texture_origin = soup_.texture_origin,
                      .origin = soup_.origin,
                      .triangle_features = soup_.polygon_features});
  for (std::size_t begin = 0; begin < triangles_.size(); begin += most) {
    TriangleMesh piece = cutter.cut(begin, std::min(triangles_.size(), begin + most));
    piece.materials = soup_.materials;
    piece.textures = soup_.textures;
    piece.feature_names = soup_.feature_names;
    take(piece);
  }
}

void StreamedMesh::check_distances(const FileErrors& errors) const {
  for_each_index(is_used_.size(), [&](std::size_t v) {
    const glm::vec3& p = soup_.positions[v];
    if (!is_used_[v] || std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) <= farthest_coordinate) return;
    errors.fail(fmt::format("vertex {}, numbered from 0", v), "is farther than 1.5e37 from the origin",
                "scale the mesh down");
  });
}

bool StreamedMesh::has_repeated_corner(const Triangle& t) const {
  const glm::vec3 &a = soup_.positions[t.x], &b = soup_.positions[t.y], &c = soup_.positions[t.z];
  return a == b || b == c || c == a;
}

void StreamedMesh::drop_repeated_corners(const FileErrors& errors) {
  LargeVector<MaterialId>& materials = soup_.polygon_materials;
  LargeVector<FeatureId>& features = soup_.polygon_features;
  std::size_t kept = 0;
  for_each_index(triangles_.size(), [&](std::size_t t) {
    if (has_repeated_corner(triangles_[t])) return;
    triangles_[kept] = triangles_[t];
    if (!materials.empty()) materials[kept] = materials[t];
    if (!features.empty()) features[kept] = features[t];
    ++kept;
  });
  if (kept == 0) errors.fail("", "has no triangle with three different corners", "give a mesh with at least one");
  triangles_.resize(kept);
  if (!materials.empty()) materials.resize(kept);
  if (!features.empty()) features.resize(kept);
}

// Counts as clean() does: of the vertices at a position that only dropped triangles use, one is unreferenced and the
// others have been welded to it.
void StreamedMesh::count_unused_vertices() {
  for_each_index(static_cast<std::size_t>(report_.vertices_read), [&](std::size_t v) {
    const glm::vec3& p = soup_.positions[v];
    const bool is_finite = std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
    if (!is_used_[v]) ++(is_finite ? report_.unreferenced_vertices : report_.nonfinite_vertices);
  });
  if (triangles_.size() == report_.triangles_read) return;
  LargeVector<bool> is_kept(soup_.positions.size());
  for_each_index(triangles_.size(), [&](std::size_t t) {
    for (int k = 0; k < 3; ++k) is_kept[triangles_[t][k]] = true;
  });
  ValuesAtPlaces<std::uint8_t> lost;
  for_each_index(is_kept.size(), [&](std::size_t v) {
    if (is_used_[v] && !is_kept[v]) lost.add_place(soup_.positions[v]);
  });
  lost.begin(1);
  for_each_index(is_kept.size(), [&](std::size_t v) {
    if (!is_kept[v]) return;
    if (std::uint8_t* const is_lost = lost.find(soup_.positions[v])) *is_lost = 0;
  });
  report_.unreferenced_vertices +=
      static_cast<std::uint64_t>(std::count(lost.values().begin(), lost.values().end(), std::uint8_t{1}));
}

void StreamedMesh::repair_texture_coordinates() {
  for_each_index(soup_.texture_coordinates.size(), [&](std::size_t v) {
    glm::vec2& at = soup_.texture_coordinates[v];
    if (std::isfinite(at.x) && std::isfinite(at.y)) return;
    at = glm::vec2(0.0F);
    report_.left_out.add(not_finite_coordinates, is_used_[v] ? 1 : 0);
  });
}

void StreamedMesh::repair_normals() {
  LargeVector<VertexId> unusable;
  ValuesAtPlaces<glm::dvec3> sums;  // of area vectors
  for_each_index(soup_.normals.size(), [&](std::size_t v) {
    if (!is_used_[v] || normalize_in_place(soup_.normals[v])) return;
    unusable.push_back(static_cast<VertexId>(v));
    sums.add_place(soup_.positions[v]);
  });
  if (unusable.empty()) return;
  sums.begin(glm::dvec3(0.0));
  for_each_index(triangles_.size(), [&](std::size_t i) {
    const Triangle& t = triangles_[i];
    const glm::dvec3 area = area_vector(soup_.positions[t.x], soup_.positions[t.y], soup_.positions[t.z]);
    for (int k = 0; k < 3; ++k)
      if (glm::dvec3* const sum = sums.find(soup_.positions[t[k]])) *sum += area;
  });
  for_each_index(unusable.size(), [&](std::size_t i) {
    soup_.normals[unusable[i]] = normal_along(*sums.find(soup_.positions[unusable[i]]));
  });
}

}  // namespace occlod
