// Lists the files that an input names and that are read with it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace occlod {

struct NamedFile {
  std::filesystem::path path;
  std::string role;  // for messages, e.g. "an image of a.obj"
};

// Returns the existing files that a scene, a mesh, a hierarchy or an HLOD names, and those that they name in turn:
// meshes, material libraries, buffers and images. Returns nothing for a file that does not exist or is of another kind.
// Throws Error for a file that cannot be read. O(size).
[[nodiscard]] std::vector<NamedFile> files_named_by(const std::filesystem::path& input);

}  // namespace occlod
