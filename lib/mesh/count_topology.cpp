#include <algorithm>
#include <glm/common.hpp>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include "base/disjoint_sets.h"
#include "base/threads.h"
#include "mesh/mesh_report.h"
#include "occlod/mesh.h"

namespace occlod {
namespace {

struct Arrays {
  std::span<const glm::vec3> positions;  // one per vertex
  std::span<const Triangle> triangles;
};

bool has_repeated_corner(const Triangle& t) { return t.x == t.y || t.y == t.z || t.z == t.x; }

// Exact while the coordinates of a triangle are less than 2^26 units in the last place apart, which is nearly always
// so: the products of such differences fit in a double.
bool has_zero_area(const Arrays& mesh, const Triangle& t) {
  const glm::dvec3 a(mesh.positions[t.x]);
  const glm::dvec3 u = glm::dvec3(mesh.positions[t.y]) - a;
  const glm::dvec3 v = glm::dvec3(mesh.positions[t.z]) - a;
  return u.y * v.z == u.z * v.y && u.z * v.x == u.x * v.z && u.x * v.y == u.y * v.x;
}

// The smallest and largest vertex of each run of triangles: in most meshes, triangles near each other in the list use
// vertices near each other.
class VertexRanges {
 public:
  VertexRanges(const Arrays& mesh, unsigned threads) : mesh_(mesh), ranges_((mesh.triangles.size() + run - 1) / run) {
    constexpr std::size_t runs_a_task = 256;
    for_each_task(1 + ranges_.size() / runs_a_task, threads, [&](std::size_t task) {
      const std::size_t end = std::min((task + 1) * runs_a_task, ranges_.size());
      for (std::size_t i = task * runs_a_task; i < end; ++i) ranges_[i] = range_of(i);
    });
  }

  // Calls visit(vertex, triangle) for every corner at a vertex in [begin, end), by ascending triangles; skips triangles
  // with a repeated corner.
  template <class Visit>
  void for_each_corner(VertexId begin, VertexId end, Visit visit) const {
    for (std::size_t i = 0; i < ranges_.size(); ++i) {
      if (ranges_[i].largest < begin || ranges_[i].smallest >= end) continue;
      for (std::size_t t = i * run; t < run_end(i * run); ++t) {
        const Triangle& corners = mesh_.triangles[t];
        if (has_repeated_corner(corners)) continue;
        for (int corner = 0; corner < 3; ++corner) {
          if (corners[corner] >= begin && corners[corner] < end) visit(corners[corner], static_cast<std::uint32_t>(t));
        }
      }
    }
  }

 private:
  static constexpr std::size_t run = 1024;  // triangles

  struct Range {
    VertexId smallest;
    VertexId largest;
  };

  [[nodiscard]] Range range_of(std::size_t i) const {
    Triangle smallest(no_id);
    Triangle largest(0);
    for (std::size_t t = i * run; t < run_end(i * run); ++t) {
      smallest = glm::min(smallest, mesh_.triangles[t]);
      largest = glm::max(largest, mesh_.triangles[t]);
    }
    return {std::min({smallest.x, smallest.y, smallest.z}), std::max({largest.x, largest.y, largest.z})};
  }
  [[nodiscard]] std::size_t run_end(std::size_t begin) const { return std::min(begin + run, mesh_.triangles.size()); }

  const Arrays& mesh_;
  std::vector<Range> ranges_;
};

// The triangles around each of some consecutive vertices, as one array with offsets.
class Stars {
 public:
  void collect(const VertexRanges& ranges, VertexId begin, VertexId end) {
    first_ = begin;
    offsets_.assign(std::size_t{end} - begin + 1, 0);
    ranges.for_each_corner(begin, end, [&](VertexId v, std::uint32_t) { ++offsets_[v - first_]; });
    std::partial_sum(offsets_.begin(), offsets_.end(), offsets_.begin());
    triangles_.resize(offsets_.back());
    ranges.for_each_corner(begin, end, [&](VertexId v, std::uint32_t t) { triangles_[--offsets_[v - first_]] = t; });
  }

  [[nodiscard]] std::span<const std::uint32_t> triangles(VertexId v) const {
    const std::size_t begin = offsets_[v - first_];
    return {triangles_.data() + begin, offsets_[v - first_ + 1] - begin};
  }

 private:
  VertexId first_ = 0;
  std::vector<std::size_t> offsets_;
  std::vector<std::uint32_t> triangles_;
};

// Counts the topology at one vertex at a time, from the star of its triangles; an edge counts at its smaller vertex, a
// triangle at its smallest.
class StarCounter {
 public:
  StarCounter(const Arrays& mesh, const VertexRanges& ranges) : mesh_(mesh), ranges_(ranges) {}

  void count(VertexId begin, VertexId end) {
    stars_.collect(ranges_, begin, end);
    for (VertexId v = begin; v < end; ++v) count(v);
  }

  [[nodiscard]] const MeshReport& report() const { return report_; }

 private:
  // The edge of a triangle that does not touch the centre, in the triangle's direction.
  struct RimEdge {
    VertexId from;
    VertexId to;
  };
  // One triangle's use of the edge between the centre and `rim`.
  struct Spoke {
    VertexId rim;
    std::uint32_t slot;  // the triangle's place in the star
    bool outward;        // the triangle runs from the centre to the rim
  };

  void count(VertexId center) {
    rim_.clear();
    for (const std::uint32_t triangle : stars_.triangles(center)) {
      const Triangle& t = mesh_.triangles[triangle];
      const int corner = t.x == center ? 0 : t.y == center ? 1 : 2;
      rim_.push_back({t[(corner + 1) % 3], t[(corner + 2) % 3]});
    }
    if (sort_closed_rim()) return;
    spokes_.clear();
    opposite_.clear();
    for (std::uint32_t slot = 0; slot < rim_.size(); ++slot) add_triangle(center, slot);
    std::sort(spokes_.begin(), spokes_.end(), [](const Spoke& a, const Spoke& b) { return a.rim < b.rim; });
    count_spokes(center);
    count_repeated();
  }

  // True when the rim is one loop of at least three edges through different vertices, as around nearly every vertex.
  // Every edge at the centre then has two triangles that run through it in opposite directions, they are one fan, and
  // no two have the same corners: there is nothing to count. Sorts the edges into the loop's order, as far as it gets.
  // Long rims are not tried, because a search for each next edge takes longer than sorting them all.
  [[nodiscard]] bool sort_closed_rim() {
    constexpr std::size_t longest = 64;
    if (rim_.size() < 3 || rim_.size() > longest) return false;
    for (std::size_t i = 1; i < rim_.size(); ++i) {
      const VertexId at = rim_[i - 1].to;
      if (at == rim_[0].from) return false;
      std::size_t next = rim_.size();
      for (std::size_t j = i; j < rim_.size(); ++j) {
        if (rim_[j].from != at) continue;
        if (next != rim_.size()) return false;
        next = j;
      }
      if (next == rim_.size()) return false;
      std::swap(rim_[i], rim_[next]);
    }
    return rim_.back().to == rim_[0].from;
  }

  void add_triangle(VertexId center, std::uint32_t slot) {
    const auto [next, previous] = rim_[slot];
    spokes_.push_back({next, slot, true});
    spokes_.push_back({previous, slot, false});
    if (center < next && center < previous) opposite_.emplace_back(std::min(next, previous), std::max(next, previous));
  }

  void count_spokes(VertexId center) {
    const std::size_t star_size = rim_.size();
    std::size_t fans = star_size;
    fans_.reset(star_size);
    for (std::size_t first = 0, last = 0; first < spokes_.size(); first = last) {
      for (last = first; last < spokes_.size() && spokes_[last].rim == spokes_[first].rim; ++last) {
        fans -= fans_.join(spokes_[first].slot, spokes_[last].slot);
      }
      if (center < spokes_[first].rim) count_edge(&spokes_[first], last - first);
    }
    report_.nonmanifold_vertices += fans > 1;
  }

  void count_edge(const Spoke* uses, std::size_t count) {
    report_.boundary_edges += count == 1;
    report_.nonmanifold_edges += count > 2;
    report_.inconsistent_edges += count == 2 && uses[0].outward == uses[1].outward;
  }

  void count_repeated() {
    std::sort(opposite_.begin(), opposite_.end());
    for (std::size_t i = 1; i < opposite_.size(); ++i) report_.repeated_triangles += opposite_[i] == opposite_[i - 1];
  }

  const Arrays& mesh_;
  const VertexRanges& ranges_;
  Stars stars_;
  MeshReport report_;  // counts of all vertices so far; topology only
  std::vector<RimEdge> rim_;
  std::vector<Spoke> spokes_;
  std::vector<std::pair<VertexId, VertexId>> opposite_;  // the other two corners of each triangle counted here
  DisjointSets fans_;
};

std::uint64_t count_components(const Arrays& mesh) {
  DisjointSets sets;
  sets.reset(mesh.positions.size());
  LargeVector<bool> used(mesh.positions.size());
  std::uint64_t joins = 0;
  for (const Triangle& t : mesh.triangles) {
    used[t.x] = used[t.y] = used[t.z] = true;
    joins += sets.join(t.x, t.y);
    joins += sets.join(t.x, t.z);
  }
  return static_cast<std::uint64_t>(std::count(used.begin(), used.end(), true)) - joins;
}

std::uint64_t count_zero_areas(const Arrays& mesh, std::size_t begin, std::size_t end) {
  std::uint64_t count = 0;
  for (std::size_t t = begin; t < end; ++t) {
    count += !has_repeated_corner(mesh.triangles[t]) && has_zero_area(mesh, mesh.triangles[t]);
  }
  return count;
}

// Divides the counting into tasks for any thread: the sums do not depend on which thread did what.
class TopologyCounter {
 public:
  TopologyCounter(const Arrays& mesh, unsigned threads)
      : mesh_(mesh),
        threads_(threads),
        ranges_(mesh, threads),
        parts_(std::max(1 + std::min<std::size_t>(15, mesh.positions.size() / min_vertices),
                        mesh.positions.size() / max_vertices)) {}

  MeshReport run() {
    for_each_task(
        parts_ + 1, threads_, [this] { return Worker(*this); },
        [](Worker& worker, std::size_t task) { worker.count(task); }, [] {});
    return total_;
  }

 private:
  // Fewer vertices are not worth a part, and 16 parts are enough for the threads. The list of a part of more vertices
  // would take more than about 10 MB.
  static constexpr std::size_t min_vertices = 32768, max_vertices = std::size_t{1} << 18U;

  // The counts of one thread, which its destructor adds to the total.
  class Worker {
   public:
    explicit Worker(TopologyCounter& counter) : counter_(counter), stars_(counter.mesh_, counter.ranges_) {}
    Worker(const Worker&) = delete;
    Worker& operator=(const Worker&) = delete;
    ~Worker() { counter_.add(stars_.report(), zero_areas_, components_); }

    void count(std::size_t task) {
      const Arrays& mesh = counter_.mesh_;
      if (task == 0) {  // the longest comes first
        components_ = count_components(mesh);
        return;
      }
      const std::size_t part = task - 1, parts = counter_.parts_;
      const auto part_of = [&](std::size_t count) {
        return std::pair{part * count / parts, (part + 1) * count / parts};
      };
      const auto [first_vertex, last_vertex] = part_of(mesh.positions.size());
      stars_.count(static_cast<VertexId>(first_vertex), static_cast<VertexId>(last_vertex));
      const auto [first_triangle, last_triangle] = part_of(mesh.triangles.size());
      zero_areas_ += count_zero_areas(mesh, first_triangle, last_triangle);
    }

   private:
    TopologyCounter& counter_;
    StarCounter stars_;
    std::uint64_t zero_areas_ = 0;
    std::uint64_t components_ = 0;
  };

  void add(const MeshReport& stars, std::uint64_t zero_areas, std::uint64_t components) {
    const std::scoped_lock lock(mutex_);
    total_.zero_area_triangles += zero_areas;
    total_.components += components;
    total_.repeated_triangles += stars.repeated_triangles;
    total_.boundary_edges += stars.boundary_edges;
    total_.nonmanifold_edges += stars.nonmanifold_edges;
    total_.inconsistent_edges += stars.inconsistent_edges;
    total_.nonmanifold_vertices += stars.nonmanifold_vertices;
  }

  const Arrays& mesh_;
  const unsigned threads_;
  const VertexRanges ranges_;
  const std::size_t parts_;
  std::mutex mutex_;
  MeshReport total_;
};

}  // namespace

void count_topology(std::span<const glm::vec3> positions, std::span<const Triangle> triangles, MeshReport& report,
                    int threads) {
  const MeshReport counted = TopologyCounter({positions, triangles}, thread_count(threads)).run();
  report.zero_area_triangles = counted.zero_area_triangles;
  report.repeated_triangles = counted.repeated_triangles;
  report.boundary_edges = counted.boundary_edges;
  report.nonmanifold_edges = counted.nonmanifold_edges;
  report.inconsistent_edges = counted.inconsistent_edges;
  report.nonmanifold_vertices = counted.nonmanifold_vertices;
  report.components = counted.components;
}

void count_topology(const TriangleMesh& mesh, MeshReport& report, int threads) {
  count_topology(std::span(mesh.positions).first(mesh.vertex_count()), mesh.triangles, report, threads);
}

}  // namespace occlod
