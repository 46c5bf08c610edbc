// An HLOD as one string, so that two can be compared.
#pragma once

#include <span>
#include <string>

#include "occlod/hlod.h"

namespace occlod::hlod::test {

[[nodiscard]] inline std::string bytes_of(const Hlod& hlod) {
  std::string bytes;
  const auto add = [&](const auto& values) {
    const auto raw = std::as_bytes(values);
    bytes.append(reinterpret_cast<const char*>(raw.data()), raw.size());
  };
  const HlodView& view = hlod.data();
  add(view.nodes);
  add(view.patches);
  add(view.children);
  add(view.roots);
  add(view.levels);
  add(view.meshes);
  add(view.within);
  add(view.splits);
  return bytes;
}

}  // namespace occlod::hlod::test
