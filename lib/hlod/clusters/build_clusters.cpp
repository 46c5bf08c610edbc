// Levels of clusters, each made of groups of the level below as the nodes of an HLOD are: groups by an octree that is
// shifted from level to level, border vertices locked, so that any cut is without cracks (docs/internals/hlod.md). A
// node of an HLOD is the result of simplifying one group here, and a patch is cut into clusters.
//
// The rule of cutting is that of meshoptimizer's clusterlod.h, which is Karis's (Nanite, a deep dive, 2021).
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "base/option_checker.h"
#include "base/threads.h"
#include "hlod/build/finish_level.h"
#include "hlod/build/group_triangles.h"
#include "hlod/build/level_draft.h"
#include "hlod/build/simplify_nodes.h"
#include "hlod/clusters/bounding_sphere.h"
#include "hlod/clusters/cut_clusters.h"
#include "occlod/clusters.h"
#include "splits/build_progress.h"
#include "splits/build_steps.h"

namespace occlod::hlod {
namespace {

constexpr double min_progress = 0.97;  // a level with a larger share of the triangles below it is left out

Reduction cluster_reduction(std::uint32_t max_triangles) {
  return {.node_triangles = 0,  // level 0 is one node
          .group_triangles = 16 * max_triangles,
          .wanted_share = 0.48,  // levels halve, as groups with many locked vertices keep more
          .least_share = 0.24,
          .sampled_groups = 16,
          .smallest_patch = max_triangles / 4,
          .largest_group = 24 * max_triangles,
          .keeps_bounds = false};
}

// The clusters of one group, before they are numbered.
struct GroupDraft {
  struct ClusterDraft {
    std::uint32_t triangles = 0, vertices = 0;
    std::uint32_t node = 0;  // of its level
    MaterialId material = 0;
  };
  std::vector<std::uint32_t> triangles;  // of the level, cluster by cluster
  std::vector<ClusterDraft> clusters;
};

class ClusterBuilder {
 public:
  ClusterBuilder(const TriangleMesh& mesh, const ClusterOptions& options)
      : options_(options),
        threads_(thread_count(options.threads)),
        progress_(options.progress),
        mesh_(to_wedge_mesh(mesh, threads_)),
        grouping_(mesh_, Grouping::shifted, cluster_reduction(options.max_triangles), threads_),
        simplifier_(mesh_, hlod_options_, cluster_reduction(options.max_triangles), threads_, nullptr) {
    hlod_options_.error_bound = options.error_bound;
  }

  ClusterLod run() {
    progress_.reach(0.0);
    LevelDraft level =
        input_level(mesh_, {UninitializedVector<std::uint32_t>(mesh_.triangles.size(), 0U), 1}, threads_);
    lod_.input_triangles = level.triangles.size();
    while (level.triangles.size() > options_.max_triangles) {
      LevelDraft above = level_above(level);
      const bool is_worth = !above.triangles.empty() && static_cast<double>(above.triangles.size()) <=
                                                            min_progress * static_cast<double>(level.triangles.size());
      if (!is_worth) break;
      add_level(level, above.nodes.size(), above.nodes);
      level = std::move(above);
    }
    level.parent_of.resize(level.triangles.size());
    for (std::uint32_t n = 0; n < level.nodes.size(); ++n)
      std::fill_n(level.parent_of.begin() + level.nodes[n].first_triangle, level.nodes[n].triangle_count, n);
    add_level(level, level.nodes.size(), {});
    sort_input_by_material();
    take_vertices();
    progress_.reach(1.0);
    return std::move(lod_);
  }

 private:
  LevelDraft level_above(LevelDraft& level) {
    TriangleGroups groups = grouping_.group_level(level, ++level_number_);
    const double before = done_;
    done_ += (1.0 - done_) / 2.0;
    const ProgressPart part{progress_, before, done_, static_cast<double>(level.triangles.size())};
    return simplifier_.run(level, std::move(groups), part);
  }

  // Adds the groups of a level and their clusters. `above` are the nodes that replace the groups; none for the last.
  void add_level(const LevelDraft& level, std::size_t group_count, std::span<const NodeDraft> above) {
    const std::vector<GroupDraft> drafts = cut(level, group_count);
    const auto first_group = static_cast<std::uint32_t>(lod_.groups.size());
    const std::span<const Triangle> wedges = level.wedge_triangles();
    for (std::size_t g = 0; g < drafts.size(); ++g) {
      ClusterGroup& group = lod_.groups.emplace_back();
      group.level = level_count_;
      group.first_cluster = static_cast<std::uint32_t>(lod_.clusters.size());
      group.cluster_count = static_cast<std::uint32_t>(drafts[g].clusters.size());
      if (!above.empty())
        group.error = options_.error_bound == ErrorBound::measured ? above[g].guaranteed_error : above[g].error;
      std::size_t next = 0;
      for (const GroupDraft::ClusterDraft& draft : drafts[g].clusters) {
        Cluster& cluster = lod_.clusters.emplace_back();
        cluster.first_index = static_cast<std::uint32_t>(lod_.indices.size());
        cluster.index_count = 3 * draft.triangles;
        cluster.vertex_count = draft.vertices;
        cluster.group = first_group + static_cast<std::uint32_t>(g);
        cluster.level = level_count_;
        cluster.material = draft.material;
        if (level_count_ > 0) {
          cluster.refined = first_below_ + draft.node;
          cluster.error = lod_.groups[cluster.refined].error;
        }
        for (std::uint32_t i = 0; i < draft.triangles; ++i, ++next) {
          const Triangle& t = wedges[drafts[g].triangles[next]];
          lod_.indices.insert(lod_.indices.end(), {t.x, t.y, t.z});
        }
      }
    }
    bound(first_group);
    first_below_ = first_group;
    ++level_count_;
  }

  // Cuts each group of the level into clusters of one node and one material.
  std::vector<GroupDraft> cut(const LevelDraft& level, std::size_t group_count) const {
    const std::span<const Triangle> wedges = level.wedge_triangles();
    std::vector<std::uint32_t> node_of(level.nodes.size() > 1 ? level.triangles.size() : 0);
    for (std::uint32_t n = 0; n < level.nodes.size() && !node_of.empty(); ++n)
      std::fill_n(node_of.begin() + level.nodes[n].first_triangle, level.nodes[n].triangle_count, n);
    std::vector<GroupDraft> drafts(group_count);
    for (std::uint32_t t = 0; t < level.triangles.size(); ++t) drafts[level.parent_of[t]].triangles.push_back(t);
    const auto kind = [&](std::uint32_t t) {
      return std::pair(node_of.empty() ? 0 : node_of[t], mesh_.material_of(wedges[t].x));
    };
    for_each_task(
        group_count, threads_, [&] { return ClusterCutter(mesh_, options_.max_triangles); },
        [&](ClusterCutter& cutter, std::size_t g) {
          GroupDraft& draft = drafts[g];
          if (!mesh_.wedge_materials.empty())  // by node they are in order already
            std::stable_sort(draft.triangles.begin(), draft.triangles.end(),
                             [&](std::uint32_t a, std::uint32_t b) { return kind(a) < kind(b); });
          std::vector<ClusterCutter::Piece> pieces;
          for (std::size_t begin = 0, end = 0; begin < draft.triangles.size(); begin = end) {
            const auto [node, material] = kind(draft.triangles[begin]);
            while (end < draft.triangles.size() && kind(draft.triangles[end]) == std::pair(node, material)) ++end;
            pieces.clear();
            cutter.cut(wedges, std::span(draft.triangles).subspan(begin, end - begin), pieces);
            for (const auto& [triangles, vertices] : pieces)
              draft.clusters.push_back({triangles, vertices, node, material});
          }
        },
        [] {});
    return drafts;
  }

  // Computes the spheres of groups from `first` on and of their clusters.
  void bound(std::uint32_t first) {
    for_each_task(lod_.groups.size() - first, threads_, [&](std::size_t i) {
      ClusterGroup& group = lod_.groups[first + i];
      std::vector<Sphere> points, spheres;
      for (std::uint32_t c = group.first_cluster; c < group.first_cluster + group.cluster_count; ++c) {
        Cluster& cluster = lod_.clusters[c];
        points.clear();
        for (std::uint32_t k = 0; k < cluster.index_count; ++k)
          points.push_back({mesh_.positions[lod_.indices[cluster.first_index + k]], 0.0F});
        cluster.sphere = sphere_around(points);
        spheres.push_back(cluster.refined == no_id ? cluster.sphere : lod_.groups[cluster.refined].sphere);
      }
      if (!spheres.empty()) group.sphere = sphere_around(spheres);
    });
  }

  // Moves the indices of level 0, so that each material has one run of them.
  void sort_input_by_material() {
    if (mesh_.wedge_materials.empty()) return;
    std::vector<std::uint32_t> order;
    for (std::uint32_t c = 0; c < lod_.clusters.size() && lod_.clusters[c].level == 0; ++c) order.push_back(c);
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return lod_.clusters[a].material < lod_.clusters[b].material;
    });
    std::vector<std::uint32_t> sorted;
    for (const std::uint32_t c : order) {
      Cluster& cluster = lod_.clusters[c];
      const auto first = lod_.indices.begin() + cluster.first_index;
      cluster.first_index = static_cast<std::uint32_t>(sorted.size());
      sorted.insert(sorted.end(), first, first + cluster.index_count);
    }
    std::ranges::copy(sorted, lod_.indices.begin());
  }

  void take_vertices() {
    TriangleMesh& to = lod_.vertices;
    const auto copy = [](const auto& from, auto& values) { values.assign(from.begin(), from.end()); };
    copy(mesh_.positions, to.positions);
    copy(mesh_.normals, to.normals);
    copy(mesh_.colors, to.colors);
    copy(mesh_.texture_coordinates, to.texture_coordinates);
    to.materials = std::move(mesh_.materials);
    to.textures = std::move(mesh_.textures);
    to.texture_origin = mesh_.texture_origin;
    to.origin = mesh_.origin;
    to.up = mesh_.up;
  }

  const ClusterOptions& options_;
  HlodBuildOptions hlod_options_;
  unsigned threads_;
  BuildProgress progress_;
  WedgeMesh mesh_;
  TriangleGrouping grouping_;
  NodeSimplifier simplifier_;
  unsigned level_number_ = 0;
  double done_ = 0.0;
  std::uint32_t level_count_ = 0;
  std::uint32_t first_below_ = 0;  // the first group of the level below, whose results are the nodes of this one
  ClusterLod lod_;
};

void check_options(const ClusterOptions& options) {
  const OptionChecker check("clusters");
  check.in_range("max_triangles", options.max_triangles, 32, 256);
  check.in_range("threads", options.threads, 0, 1024);
}

}  // namespace

ClusterLod build_clusters(const TriangleMesh& mesh, const ClusterOptions& options) {
  check_options(options);
  check_input(mesh);
  check_welded(mesh);
  const LargeMemoryReuse reuse;
  return ClusterBuilder(mesh, options).run();
}

double projected_error(const Sphere& sphere, float error, const glm::dvec3& eye, double scale_px, double near) {
  const double distance = glm::distance(glm::dvec3(sphere.center), eye) - static_cast<double>(sphere.radius);
  return static_cast<double>(error) / std::max(distance, near) * scale_px;
}

}  // namespace occlod::hlod
