// The cut of a view cell, whoever found it.
#pragma once

#include <memory>
#include <string>

#include "occlod/cell_builder.h"
#include "refining.h"

namespace occlod::python {

// What CellBuilder::build() gave or a file had, copied.
struct PythonCellCut {
  CellCut cut;
  std::shared_ptr<const KeptObjects> objects;

  // Throws IndexError.
  [[nodiscard]] const CellObjectCut& object(std::size_t i) const {
    if (i >= cut.objects.size())
      throw nb::index_error(("there are " + std::to_string(cut.objects.size()) + " objects").c_str());
    return cut.objects[i];
  }
  [[nodiscard]] const PlacedObject& placed(std::size_t i) const { return objects->objects()[i]; }
};

}  // namespace occlod::python
