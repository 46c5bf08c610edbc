#include "peers/openmesh_vdpm.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModNormalFlippingT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>
#include <OpenMesh/Tools/VDPM/MeshTraits.hh>
#include <OpenMesh/Tools/VDPM/VFront.hh>
#include <OpenMesh/Tools/VDPM/VHierarchy.hh>
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/mat4x4.hpp>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <tuple>
#include <utility>
#include <vector>

#include "occlod/openmesh.h"

namespace occlod::bench {
namespace {

using OpenMesh::Vec3f;
using OpenMesh::VertexHandle;
using OpenMesh::VDPM::VHierarchyNode;
using HalfEdgeMesh = OpenMesh::TriMesh_ArrayKernelT<OpenMesh::VDPM::MeshTraits>;
using NodeHandle = OpenMesh::VDPM::VHierarchyNodeHandle;

std::size_t index(const OpenMesh::BaseHandle& handle) { return static_cast<std::size_t>(handle.idx()); }

NodeHandle node_at(std::size_t i) { return NodeHandle(static_cast<int>(i)); }

// v0 moved onto v1; the faces left and right of the edge went, with their third corners vl and vr.
struct Collapse {
  VertexHandle v0, v1, vl, vr;
  OpenMesh::FaceHandle fl, fr;
};

// A module of the decimater that allows every collapse and writes down those that are done.
template <class MeshT>
struct CollapseRecorder : OpenMesh::Decimater::ModBaseT<MeshT> {
  DECIMATING_MODULE(CollapseRecorder, MeshT, CollapseRecorder);
  explicit CollapseRecorder(MeshT& mesh) : Base(mesh, true) {}
  void postprocess_collapse(const CollapseInfo& c) override {
    collapses.push_back({c.v0, c.v1, c.vl, c.vr, c.fl, c.fr});
  }
  std::vector<Collapse> collapses;
};

std::vector<Collapse> decimate(HalfEdgeMesh& mesh, std::size_t base_triangles) {
  OpenMesh::Decimater::DecimaterT<HalfEdgeMesh> decimater(mesh);
  OpenMesh::Decimater::ModQuadricT<HalfEdgeMesh>::Handle quadric;
  OpenMesh::Decimater::ModNormalFlippingT<HalfEdgeMesh>::Handle flipping;
  OpenMesh::Decimater::ModHandleT<CollapseRecorder<HalfEdgeMesh>> recorder;
  decimater.add(quadric);
  decimater.module(quadric).unset_max_err();  // orders collapses, forbids none
  decimater.add(flipping);
  decimater.add(recorder);
  decimater.initialize();
  decimater.decimate_to_faces(0, base_triangles);
  return decimater.module(recorder).collapses;
}

// Of each collapse the corners of its two faces, in the input mesh, that vl and vr stood for at the time.
using Cut = std::pair<std::uint32_t, std::uint32_t>;
std::vector<Cut> fundamental_cuts(const std::vector<Triangle>& triangles, const std::vector<Collapse>& collapses,
                                  std::size_t vertices) {
  std::vector<std::uint32_t> moved_to(vertices);
  std::iota(moved_to.begin(), moved_to.end(), 0U);
  const auto now = [&](std::uint32_t v) {
    while (moved_to[v] != v) v = moved_to[v] = moved_to[moved_to[v]];
    return v;
  };
  const auto corner = [&](OpenMesh::FaceHandle face, VertexHandle v) {
    const Triangle& triangle = triangles[index(face)];
    for (int i = 0; i < 3; ++i)
      if (now(triangle[i]) == index(v)) return triangle[i];
    throw std::runtime_error("a collapsed face has lost its corner");
  };
  std::vector<Cut> cuts;
  for (const Collapse& c : collapses) {
    cuts.emplace_back(corner(c.fl, c.vl), corner(c.fr, c.vr));
    moved_to[index(c.v0)] = static_cast<std::uint32_t>(c.v1.idx());
  }
  return cuts;
}

// All vertices of the decimated mesh, those that collapses have taken too, and the faces that are left.
HalfEdgeMesh base_of(const HalfEdgeMesh& decimated) {
  HalfEdgeMesh base;
  for (const auto v : decimated.all_vertices()) base.add_vertex(decimated.point(v));
  for (const auto f : decimated.all_faces()) {
    if (decimated.status(f).deleted()) continue;
    auto corner = decimated.cfv_iter(f);
    const VertexHandle a = *corner++;
    const VertexHandle b = *corner++;
    base.add_face(a, b, *corner);
  }
  return base;
}

// Leaves numbered from left to right: ancestry at any depth, where the package's index of 32 bits for root and path
// together holds only balanced forests.
struct LeafRange {
  std::uint32_t first = 0, count = 0;

  [[nodiscard]] bool holds(std::uint32_t leaf) const { return leaf - first < count; }
};

// What a node may stand for: the sphere around its vertex that holds all below, how far these lie off along the normal,
// and the cone of their normals.
struct NodeBounds {
  float radius = 0.0F, error = 0.0F, cone_rad = 0.0F;
};

float angle_between(const Vec3f& a, const Vec3f& b) { return std::acos(std::clamp(a | b, -1.0F, 1.0F)); }

}  // namespace

struct VdpmForest::Impl {
  HalfEdgeMesh base;
  OpenMesh::VDPM::VHierarchy tree;  // parents before their children
  OpenMesh::VDPM::VHierarchyNodeHandleContainer roots;
  std::vector<LeafRange> leaves;  // below each node
  std::vector<Cut> cuts;          // of each inner node, leaves
  std::size_t splits = 0;

  // Undoes the collapses; fills `node_of` with the leaf of each vertex and returns the collapse of each inner node.
  std::vector<std::size_t> add_nodes(const HalfEdgeMesh& decimated, const std::vector<Collapse>& collapses,
                                     std::vector<NodeHandle>& node_of) {
    const auto add = [&](VertexHandle v) {
      const NodeHandle added = tree.add_node();
      tree.node(added).set_vertex_handle(v);
      return node_of[index(v)] = added;
    };
    for (const auto v : decimated.all_vertices()) {
      if (decimated.status(v).deleted()) continue;
      roots.push_back(add(v));
      base.data(v).set_vhierarchy_node_handle(roots.back());
    }
    tree.set_num_roots(static_cast<unsigned>(roots.size()));
    std::vector<std::size_t> collapse_of(roots.size() + 2 * collapses.size());
    for (std::size_t k = collapses.size(); k-- > 0;) {
      const NodeHandle parent = node_of[index(collapses[k].v1)];
      collapse_of[index(parent)] = k;
      const NodeHandle left = add(collapses[k].v0);
      const NodeHandle right = add(collapses[k].v1);
      tree.node(parent).set_children_handle(left);
      tree.node(left).set_parent_handle(parent);
      tree.node(right).set_parent_handle(parent);
    }
    return collapse_of;
  }

  void count_leaves() {
    leaves.resize(tree.num_nodes());
    for (std::size_t i = leaves.size(); i-- > 0;) {
      VHierarchyNode& node = tree.node(node_at(i));
      leaves[i].count =
          node.is_leaf() ? 1 : leaves[index(node.lchild_handle())].count + leaves[index(node.rchild_handle())].count;
    }
    std::uint32_t next = 0;
    for (std::size_t i = 0; i < leaves.size(); ++i) {
      VHierarchyNode& node = tree.node(node_at(i));
      if (node.is_root()) leaves[i].first = std::exchange(next, next + leaves[i].count);
      if (node.is_leaf()) continue;
      LeafRange& left = leaves[index(node.lchild_handle())];
      left.first = leaves[i].first;
      leaves[index(node.rchild_handle())].first = left.first + left.count;
    }
  }

  void bound_nodes(const HalfEdgeMesh& decimated, const std::vector<Vec3f>& normals) {
    std::vector<NodeBounds> bounds(tree.num_nodes());
    for (std::size_t i = bounds.size(); i-- > 0;) {
      VHierarchyNode& node = tree.node(node_at(i));
      NodeBounds& b = bounds[i];
      if (node.is_leaf()) {
        node.set_normal(normals[index(node.vertex_handle())]);
      } else {
        const VHierarchyNode& left = tree.node(node.lchild_handle());
        const VHierarchyNode& right = tree.node(node.rchild_handle());
        const NodeBounds& l = bounds[index(node.lchild_handle())];
        const NodeBounds& r = bounds[index(node.rchild_handle())];
        const Vec3f edge = decimated.point(left.vertex_handle()) - decimated.point(right.vertex_handle());
        b.radius = std::max(r.radius, l.radius + edge.norm());
        b.error = std::max(r.error, l.error + std::abs(edge | right.normal()));
        const Vec3f sum = left.normal() + right.normal();
        node.set_normal(sum.norm() > 1e-6F ? sum.normalized() : right.normal());
        b.cone_rad = std::max(angle_between(node.normal(), left.normal()) + l.cone_rad,
                              angle_between(node.normal(), right.normal()) + r.cone_rad);
      }
      node.set_radius(b.radius);
      node.set_sigma(b.error);
      constexpr float widest_rad = 1.5F;
      if (b.cone_rad < widest_rad)
        node.set_semi_angle(b.cone_rad);
      else
        node.set_sin_square(2.0F);  // never faces away
    }
  }
};

VdpmForest::VdpmForest(const TriangleMesh& mesh, std::size_t base_triangles) : impl_(std::make_unique<Impl>()) {
  HalfEdgeMesh decimated;
  if (to_openmesh(mesh, decimated) > 0) throw std::runtime_error("OpenMesh's VDPM needs a manifold");
  for (const auto e : decimated.edges())
    if (decimated.is_boundary(e)) throw std::runtime_error("OpenMesh's VDPM is joined for closed meshes only");
  decimated.update_normals();
  std::vector<Vec3f> normals;
  for (const auto v : decimated.vertices()) normals.push_back(decimated.normal(v));
  const std::vector<Collapse> collapses = decimate(decimated, base_triangles);
  const std::vector<Cut> cuts = fundamental_cuts(mesh.triangles, collapses, mesh.vertex_count());
  impl_->splits = collapses.size();
  impl_->base = base_of(decimated);
  std::vector<NodeHandle> leaf_of(mesh.vertex_count());
  const std::vector<std::size_t> collapse_of = impl_->add_nodes(decimated, collapses, leaf_of);
  impl_->count_leaves();
  impl_->bound_nodes(decimated, normals);
  impl_->cuts.resize(collapse_of.size());
  for (std::size_t i = 0; i < collapse_of.size(); ++i) {
    if (impl_->tree.node(node_at(i)).is_leaf()) continue;
    const auto [left, right] = cuts[collapse_of[i]];
    impl_->cuts[i] = {impl_->leaves[index(leaf_of[left])].first, impl_->leaves[index(leaf_of[right])].first};
  }
}

VdpmForest::~VdpmForest() = default;

namespace {

// Which nodes a view wants split.
class Criterion {
 public:
  Criterion(const View& view, double tolerance) : tolerance_squared_(static_cast<float>(tolerance * tolerance)) {
    const ObjectView object(view, glm::dmat4(1.0));
    eye_ = Vec3f(object.eye().x, object.eye().y, object.eye().z);
    for (std::size_t i = 0; i < sides_.size(); ++i) {
      const glm::vec4& plane = object.planes()[i];
      sides_[i] = Vec3f(plane.x, plane.y, plane.z);
    }
  }

  [[nodiscard]] bool wants(const VHierarchyNode& node, const Vec3f& position) const {
    const Vec3f from_eye = position - eye_;
    for (const Vec3f& side : sides_)
      if ((side | from_eye) < -node.radius()) return false;
    const float distance_squared = from_eye.sqrnorm();
    const float along = from_eye | node.normal();
    // The cone of normals seen from the vertex is that from everywhere below only if these are near beside the eye.
    const bool is_small = node.radius() * node.radius() < 0.01F * distance_squared;
    if (is_small && along > 0.0F && along * along > distance_squared * node.sin_square()) return false;
    return node.sigma_square() > tolerance_squared_ * distance_squared;
  }

 private:
  Vec3f eye_;
  std::array<Vec3f, 4> sides_;  // of the frustum, inward; all go through the eye
  float tolerance_squared_;
};

}  // namespace

struct VdpmRefiner::Impl {
  explicit Impl(VdpmForest::Impl& shared) : forest(shared) {}

  VdpmForest::Impl& forest;  // not const, as the accessors of OpenMesh's containers are not
  HalfEdgeMesh mesh;
  OpenMesh::VDPM::VFront front;
  std::optional<Criterion> criterion;  // none: everything is wanted
  VdpmChanges changes;

  bool wants(NodeHandle h) {
    const VHierarchyNode& node = forest.tree.node(h);
    return !criterion || criterion->wants(node, mesh.point(node.vertex_handle()));
  }

  // The neighbours that stand for the two cut leaves of `h`; invalid where there is none.
  std::pair<VertexHandle, VertexHandle> cut_neighbours(NodeHandle h) {
    const Cut& cut = forest.cuts[index(h)];
    VertexHandle left, right;
    for (auto it = mesh.cvv_iter(forest.tree.vertex_handle(h)); it.is_valid(); ++it) {
      const LeafRange& leaves = forest.leaves[index(mesh.data(*it).vhierarchy_node_handle())];
      if (!left.is_valid() && leaves.holds(cut.first)) left = *it;
      if (!right.is_valid() && leaves.holds(cut.second)) right = *it;
      if (left.is_valid() && right.is_valid()) break;
    }
    return {left, right};
  }

  // One neighbour for both leaves is too coarse: it is split first.
  void split(NodeHandle h) {
    auto [vl, vr] = cut_neighbours(h);
    while (vl == vr && vl.is_valid()) {
      ++changes.forced_splits;
      split(mesh.data(vl).vhierarchy_node_handle());
      std::tie(vl, vr) = cut_neighbours(h);
    }
    if (!vl.is_valid() || !vr.is_valid()) throw std::runtime_error("OpenMesh's VDPM: a vertex has no cut neighbour");
    const NodeHandle left = forest.tree.lchild_handle(h);
    const NodeHandle right = forest.tree.rchild_handle(h);
    const VertexHandle v0 = forest.tree.vertex_handle(left);
    const VertexHandle v1 = forest.tree.vertex_handle(right);
    mesh.vertex_split(v0, v1, vl, vr);
    mesh.set_normal(v0, forest.tree.normal(left));
    mesh.set_normal(v1, forest.tree.normal(right));
    mesh.data(v0).set_vhierarchy_node_handle(left);
    mesh.data(v1).set_vhierarchy_node_handle(right);
    mesh.status(v0).set_deleted(false);
    front.remove(h);
    front.add(left);
    front.add(right);
    ++changes.splits;
  }

  bool merge(NodeHandle parent) {
    const NodeHandle left = forest.tree.lchild_handle(parent);
    const NodeHandle right = forest.tree.rchild_handle(parent);
    if (!front.is_active(left) || !front.is_active(right)) return false;
    const VertexHandle v0 = forest.tree.vertex_handle(left);
    const VertexHandle v1 = forest.tree.vertex_handle(right);
    const OpenMesh::HalfedgeHandle edge(mesh.find_halfedge(v0, v1).idx());
    if (!edge.is_valid() || !mesh.is_collapse_ok(edge) || wants(parent)) return false;
    mesh.collapse(edge);
    mesh.set_normal(v1, forest.tree.normal(parent));
    mesh.data(v0).set_vhierarchy_node_handle(left);
    mesh.data(v1).set_vhierarchy_node_handle(parent);
    mesh.status(v0).set_deleted(false);  // the vertex stays, for later splits
    front.add(parent);
    front.remove(left);
    front.remove(right);
    ++changes.merges;
    return true;
  }

  VdpmChanges sweep() {
    changes = {};
    for (front.begin(); !front.end();) {
      const NodeHandle h = front.node_handle();
      if (!forest.tree.is_leaf_node(h) && wants(h))
        split(h);
      else if (forest.tree.is_root_node(h) || !merge(forest.tree.parent_handle(h)))
        front.next();
    }
    if (changes.merges > 0) mesh.garbage_collection(false, true, true);
    return changes;
  }
};

VdpmRefiner::VdpmRefiner(const VdpmForest& forest) : impl_(std::make_unique<Impl>(*forest.impl_)) { restart(); }

VdpmRefiner::~VdpmRefiner() = default;

void VdpmRefiner::restart() {
  impl_->mesh = impl_->forest.base;
  impl_->front = {};
  impl_->front.init(impl_->forest.roots, static_cast<unsigned>(impl_->forest.splits));
}

VdpmChanges VdpmRefiner::refine(const View& view, double tolerance) {
  impl_->criterion.emplace(view, tolerance);
  return impl_->sweep();
}

VdpmChanges VdpmRefiner::refine_all() {
  impl_->criterion.reset();
  return impl_->sweep();
}

std::size_t VdpmRefiner::triangles() const {
  const auto faces = impl_->mesh.all_faces();
  return static_cast<std::size_t>(
      std::count_if(faces.begin(), faces.end(), [](const auto& f) { return !f.deleted(); }));
}

std::uint64_t VdpmRefiner::hash() const {
  std::uint64_t hash = 0;
  for (impl_->front.begin(); !impl_->front.end(); impl_->front.next())
    hash = hash * 31 + index(impl_->front.node_handle());
  return hash;
}

TriangleMesh VdpmRefiner::mesh() const { return from_openmesh(impl_->mesh); }

}  // namespace occlod::bench
