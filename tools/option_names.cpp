#include "option_names.h"
#include "refine/tuning.h"

namespace occlod::tool {

const char* name_of(Culling culling) { return culling == Culling::subtree ? "subtree" : "star"; }

const char* name_of(OccluderMode mode) { return mode == OccluderMode::conservative ? "conservative" : "paper"; }

const char* name_of(Proxy proxy) {
  switch (proxy) {
    case Proxy::sphere:
      return "sphere";
    case Proxy::box:
      return "box";
    case Proxy::cylinder:
      break;
  }
  return "cylinder";
}

const char* name_of(CellOcclusion occlusion) {
  switch (occlusion) {
    case CellOcclusion::none:
      return "none";
    case CellOcclusion::hull:
      return "hull";
    case CellOcclusion::sampled:
      break;
  }
  return "sampled";
}

const char* name_of(CellDivision division) { return division == CellDivision::gain ? "gain" : "halving"; }

}  // namespace occlod::tool
