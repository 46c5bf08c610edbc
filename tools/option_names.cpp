#include "option_names.h"

namespace occlod::tool {

const char* name_of(Method method) { return method == Method::paper ? "paper" : "occlod"; }

const char* name_of(OccluderMode mode) { return mode == OccluderMode::conservative ? "conservative" : "paper"; }

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
