// An open file of view cells in Python.
#pragma once

#include <filesystem>
#include <memory>

#include "occlod/vlod_file.h"
#include "refining.h"

namespace occlod::python {

struct PythonVlodFile {
  std::shared_ptr<const VlodFile> file;
  std::shared_ptr<const KeptObjects> objects;  // none: its cells can be looked at, and walked through if it is packed
};

// Opens it. `objects`: an object, a hierarchy or a sequence of them, or None.
[[nodiscard]] PythonVlodFile open_file(const std::filesystem::path& path, nb::handle objects);

}  // namespace occlod::python
