#include "queries/query_shape.h"

namespace occlod {

VisibilityQuery query_about(const Entry& entry, const Hierarchy& hierarchy, Proxy proxy, StarVisibility& star) {
  if (entry.kind == Entry::Kind::apply) return {entry.object, PointHull{star.points(hierarchy, entry.split)}};
  const SplitNode& node = hierarchy.node(entry.split);
  switch (proxy) {
    case Proxy::sphere:
      return {entry.object, node.sphere};
    case Proxy::cylinder:
      return {entry.object, node.cylinder()};
    case Proxy::box:
      break;
  }
  return {entry.object, node.box()};
}

}  // namespace occlod
