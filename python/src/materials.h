// Tuples of materials and textures, of meshes and hierarchies.
#pragma once

#include <nanobind/nanobind.h>

#include <span>

#include "occlod/mesh.h"

namespace occlod::python {

constexpr const char* materials_sig = "def materials(self) -> tuple[Material, ...]";
constexpr const char* textures_sig = "def textures(self) -> tuple[Texture, ...]";

// A tuple of copies: Python's values do not change.
template <typename Value>
nanobind::tuple tuple_of(std::span<const Value> values) {
  nanobind::list copies;
  for (const Value& value : values) copies.append(nanobind::cast(value, nanobind::rv_policy::copy));
  return nanobind::tuple(copies);
}

}  // namespace occlod::python
