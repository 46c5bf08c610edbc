#include <algorithm>
#include <glm/geometric.hpp>
#include <utility>

#include "base/option_checker.h"
#include "mesh/part_giver.h"
#include "base/portable_math.h"
#include "occlod/mesh/generate.h"

namespace occlod {
namespace {

constexpr int lattice_cells = 48;  // pipes run along the edges of a lattice in the unit cube
constexpr int shortest_piece = 2;  // lattice edges; longer than a diameter, so that mitres do not cross
constexpr double thinnest = 0.003;
constexpr double thickest = 0.009;

struct Heading {
  int axis;
  int sign;
  [[nodiscard]] glm::dvec3 direction() const {
    glm::dvec3 d(0.0);
    d[axis] = sign;
    return d;
  }
};

class PipeBuilder {
 public:
  PipeBuilder(const PipesOptions& options, RandomStream& random, TriangleMesh& mesh)
      : options_(options), random_(random), mesh_(mesh) {}

  void build() {
    start();
    append_cap_center();
    append_ring(heading_.direction());
    for (int piece = 0; piece < options_.bends; ++piece) {
      advance();
      const Heading next = turn();
      const bool last = piece + 1 == options_.bends;
      append_ring(last ? heading_.direction() : next.direction());
      if (!last) heading_ = next;
    }
    append_cap_center();
    append_triangles();
  }

 private:
  void start() {
    first_vertex_ = static_cast<VertexId>(mesh_.vertex_count());
    const double radius = random_.between(thinnest, thickest);
    for (int axis = 0; axis < 3; ++axis) place_[axis] = 1 + random_.below(lattice_cells - 1);
    heading_ = {random_.below(3), 1};
    choose_sign(heading_);
    const glm::dvec3 along = heading_.direction();
    glm::dvec3 u(0.0);
    u[(heading_.axis + 1) % 3] = 1.0;
    const glm::dvec3 v = glm::cross(along, u);
    offsets_.clear();
    for (int corner = 0; corner < options_.sides; ++corner) {
      const glm::dvec2 c = unit_circle_corner(corner, options_.sides);
      offsets_.push_back(radius * (c.x * u + c.y * v));
    }
  }

  [[nodiscard]] int room(const Heading& heading) const {
    return heading.sign > 0 ? lattice_cells - 1 - place_[heading.axis] : place_[heading.axis] - 1;
  }

  // Either way at random, unless there is too little room that way.
  void choose_sign(Heading& heading) {
    if (random_.below(2) == 0) heading.sign = -heading.sign;
    if (room(heading) < shortest_piece) heading.sign = -heading.sign;
  }

  void advance() {
    const int longest = std::min(room(heading_), lattice_cells / 3);
    place_[heading_.axis] += heading_.sign * (shortest_piece + random_.below(longest - shortest_piece + 1));
  }

  Heading turn() {
    Heading next{(heading_.axis + 1 + random_.below(2)) % 3, 1};
    choose_sign(next);
    return next;
  }

  // The ring where the pipe goes over from its heading into `next`: each line of its hull runs on to the mitre plane,
  // and the offsets turn with the pipe. With next = heading, a straight cut.
  void append_ring(const glm::dvec3& next) {
    const glm::dvec3 along = heading_.direction();
    for (glm::dvec3& offset : offsets_) {
      const double beyond = next == along ? 0.0 : -glm::dot(offset, next);
      const glm::dvec3 on_mitre = offset + beyond * along;
      mesh_.positions.emplace_back(center() + on_mitre);
      offset = on_mitre - glm::dot(on_mitre, next) * next;
    }
  }

  void append_cap_center() { mesh_.positions.emplace_back(center()); }

  [[nodiscard]] glm::dvec3 center() const { return glm::dvec3(place_) / static_cast<double>(lattice_cells); }

  // Vertices: the first cap's centre, the rings, the last cap's centre. Rings run counter-clockwise seen against the
  // heading.
  void append_triangles() {
    const auto sides = static_cast<VertexId>(options_.sides);
    const auto rings = static_cast<VertexId>(options_.bends) + 1;
    const auto at = [&](VertexId ring, VertexId corner) { return first_vertex_ + 1 + ring * sides + corner % sides; };
    const VertexId last_center = at(rings, 0);
    for (VertexId corner = 0; corner < sides; ++corner) {
      mesh_.triangles.emplace_back(first_vertex_, at(0, corner + 1), at(0, corner));
      for (VertexId ring = 0; ring + 1 < rings; ++ring) {
        mesh_.triangles.emplace_back(at(ring, corner), at(ring, corner + 1), at(ring + 1, corner + 1));
        mesh_.triangles.emplace_back(at(ring, corner), at(ring + 1, corner + 1), at(ring + 1, corner));
      }
      mesh_.triangles.emplace_back(last_center, at(rings - 1, corner), at(rings - 1, corner + 1));
    }
  }

  const PipesOptions& options_;
  RandomStream& random_;
  TriangleMesh& mesh_;
  VertexId first_vertex_ = 0;
  glm::ivec3 place_{0};  // of the pipe's axis, in lattice edges
  Heading heading_{0, 1};
  std::vector<glm::dvec3> offsets_;  // of the hull's lines from the axis
};

void append_pipes(const PipesOptions& options, PartGiver& parts) {
  const OptionChecker check("pipes");
  check.in_range("pipes", options.pipes, 1, 1'000'000);
  check.in_range("bends", options.bends, 1, 100'000);
  check.in_range("sides", options.sides, 3, 4096);
  check.in_range("pipes * (bends + 1) * sides", double{1.0} * options.pipes * (options.bends + 1) * options.sides, 0.0,
                 1e9);

  RandomStream random(options.seed);
  PipeBuilder builder(options, random, parts.part);
  for (int pipe = 0; pipe < options.pipes; ++pipe) {
    builder.build();
    parts.end_component();
  }
}

}  // namespace

TriangleMesh generate_pipes(const PipesOptions& options) {
  PartGiver whole;
  append_pipes(options, whole);
  return std::move(whole.part);
}

void stream_pipes(const PipesOptions& options, const PartVisitor& visit) {
  PartGiver parts(visit);
  append_pipes(options, parts);
  parts.finish();
}

}  // namespace occlod
