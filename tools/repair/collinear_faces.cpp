#include "repair/collinear_faces.h"

#include <CGAL/boost/graph/Euler_operations.h>
#include <CGAL/boost/graph/iterator.h>

#include <set>

namespace occlod::repair {
namespace {

class CollinearFaces {
 public:
  explicit CollinearFaces(HalfedgeMesh& mesh) : mesh_(mesh) {}

  void remove(RepairCounts& counts) {
    for (const Face f : mesh_.faces()) {
      if (is_collinear(f)) waiting_.insert(f);
    }
    while (!waiting_.empty()) {
      const Face f = *waiting_.begin();
      waiting_.erase(waiting_.begin());
      const Halfedge longest = longest_side(f);
      if (mesh_.is_border(mesh_.opposite(longest)))
        drop(longest, counts);
      else
        flip(longest, counts);
    }
    for (const Face f : mesh_.faces()) counts.zero_area_kept += is_collinear(f) ? 1U : 0U;
  }

 private:
  [[nodiscard]] const Point& point(Vertex v) const { return mesh_.point(v); }
  [[nodiscard]] Vertex apex(Halfedge h) const { return mesh_.target(mesh_.next(h)); }
  [[nodiscard]] bool is_between(Vertex a, Vertex b, Vertex c) const {
    return CGAL::are_strictly_ordered_along_line(point(a), point(b), point(c));
  }
  [[nodiscard]] bool is_collinear(Halfedge h) const {
    return CGAL::collinear(point(mesh_.source(h)), point(mesh_.target(h)), point(apex(h)));
  }
  [[nodiscard]] bool is_collinear(Face f) const { return is_collinear(mesh_.halfedge(f)); }

  // Returns the side that contains the third corner. Corners of a face never lie at one place.
  [[nodiscard]] Halfedge longest_side(Face f) const {
    Halfedge h = mesh_.halfedge(f);
    for (int i = 0; i < 2 && !is_between(mesh_.source(h), apex(h), mesh_.target(h)); ++i) h = mesh_.next(h);
    return h;
  }

  // Keeps the face if the corner within is already on the border, where two fans would meet.
  void drop(Halfedge longest, RepairCounts& counts) {
    const Halfedge next = mesh_.next(longest), previous = mesh_.prev(longest);
    const bool is_pinched = mesh_.is_border(apex(longest)) && !mesh_.is_border(mesh_.opposite(next)) &&
                            !mesh_.is_border(mesh_.opposite(previous));
    if (is_pinched) return;
    const Face beside[] = {mesh_.face(mesh_.opposite(next)), mesh_.face(mesh_.opposite(previous))};
    CGAL::Euler::remove_face(longest, mesh_);
    ++counts.zero_area_dropped;
    for (const Face f : beside) wait(f);
  }

  // Each flip leaves fewer faces without area, or as many and edges of a smaller total length, so flips end.
  void flip(Halfedge longest, RepairCounts& counts) {
    const Halfedge beyond = mesh_.opposite(longest);
    const Vertex a = mesh_.source(longest), c = mesh_.target(longest), b = apex(longest), d = apex(beyond);
    const bool both = is_collinear(beyond);
    if (b == d || point(b) == point(d) || mesh_.halfedge(b, d).is_valid()) return;
    if (both && !is_between(a, d, c)) return;  // the longest side of the other one comes first
    CGAL::Euler::flip_edge(longest, mesh_);
    counts.zero_area_flipped += both ? 0U : 1U;
    for (const Halfedge side : {longest, mesh_.opposite(longest)}) {
      for (const Halfedge h : CGAL::halfedges_around_face(side, mesh_)) wait(mesh_.face(mesh_.opposite(h)));
      wait(mesh_.face(side));
    }
  }

  void wait(Face f) {
    if (f.is_valid() && is_collinear(f)) waiting_.insert(f);
  }

  HalfedgeMesh& mesh_;
  std::set<Face> waiting_;  // faces without area near which something has changed
};

}  // namespace

void remove_collinear_faces(HalfedgeMesh& mesh, RepairCounts& counts) { CollinearFaces(mesh).remove(counts); }

}  // namespace occlod::repair
