#include "repair/give_attributes.h"

#include <algorithm>
#include <array>
#include <unordered_map>

#include "mesh/wedges.h"
#include "occlod/base.h"
#include "repair/array_hash.h"

namespace occlod::repair {
namespace {

using Key = std::array<VertexId, 3>;

Key key_of(const Triangle& t) {
  Key key = {t.x, t.y, t.z};
  std::sort(key.begin(), key.end());
  return key;
}

template <class T>
void gather(const std::vector<T>& from, const std::vector<WedgeId>& wedges, std::vector<T>& to) {
  if (from.empty()) return;
  to.reserve(wedges.size());
  for (const WedgeId wedge : wedges) to.push_back(from[wedge]);
}

void gather_all(const TriangleMesh& from, const std::vector<WedgeId>& wedges, TriangleMesh& to) {
  gather(from.normals, wedges, to.normals);
  gather(from.colors, wedges, to.colors);
  gather(from.texture_coordinates, wedges, to.texture_coordinates);
}

class CornerGiver {
 public:
  CornerGiver(TriangleMesh& repaired, const std::vector<VertexId>& sources, const TriangleMesh& soup)
      : repaired_(repaired), sources_(sources), soup_(soup), materials_(soup.vertex_count()), wedges_(sources) {
    triangles_.reserve(soup.triangle_count());
    for (std::size_t t = 0; t < soup.triangle_count(); ++t) {
      triangles_.emplace(key_of(soup.triangles[t]), t);
      for (int k = 0; k < 3; ++k) materials_[soup.triangles[t][k]] = soup.material_of(t);
    }
  }

  // Appends a vertex for each corner; form_wedges() joins those that agree.
  void run() {
    std::vector<Triangle> corners(repaired_.triangle_count());
    for (std::size_t i = 0; i < corners.size(); ++i) give(i, corners[i]);
    gather_all(soup_, wedges_, repaired_);
    if (form_wedges(repaired_, std::move(corners))) return;
    throw Error({"mesh", "", "has too many vertices", "split the mesh into parts"});
  }

 private:
  void give(std::size_t i, Triangle& corners) {
    const Triangle triangle = repaired_.triangles[i];
    const Triangle from(sources_[triangle.x], sources_[triangle.y], sources_[triangle.z]);
    const auto found = triangles_.find(key_of(from));
    for (int k = 0; k < 3; ++k) {
      WedgeId wedge = from[k];
      for (int j = 0; found != triangles_.end() && j < 3; ++j) {
        if (soup_.triangles[found->second][j] == from[k]) wedge = soup_.wedge_triangles()[found->second][j];
      }
      corners[k] = static_cast<VertexId>(repaired_.positions.size());
      repaired_.positions.push_back(repaired_.positions[triangle[k]]);
      wedges_.push_back(wedge);
    }
    if (soup_.triangle_materials.empty()) return;
    repaired_.triangle_materials.push_back(found != triangles_.end() ? soup_.material_of(found->second)
                                                                     : materials_[from.x]);
  }

  TriangleMesh& repaired_;
  const std::vector<VertexId>& sources_;
  const TriangleMesh& soup_;
  std::vector<MaterialId> materials_;                               // of a triangle at each vertex
  std::vector<WedgeId> wedges_;                                     // whose attributes each vertex has
  std::unordered_map<Key, std::size_t, ArrayHash<Key>> triangles_;  // of the soup
};

}  // namespace

void give_attributes(TriangleMesh& repaired, const std::vector<VertexId>& sources, const TriangleMesh& soup) {
  repaired.materials = soup.materials;
  repaired.textures = soup.textures;
  repaired.texture_origin = soup.texture_origin;
  repaired.origin = soup.origin;
  repaired.up = soup.up;
  if (soup.corners.empty() && soup.triangle_materials.empty())
    gather_all(soup, sources, repaired);
  else
    CornerGiver(repaired, sources, soup).run();
}

}  // namespace occlod::repair
