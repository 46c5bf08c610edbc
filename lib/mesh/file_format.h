// Which mesh format a file name stands for.
#pragma once

#include <filesystem>
#include <optional>

#include "base/file_input.h"

namespace occlod {

enum class MeshFormat { ply, obj, off, stl, gltf };

// By the extension, case ignored; none for any other.
[[nodiscard]] std::optional<MeshFormat> find_format(const std::filesystem::path& path);
// The same. Throws Error for any other.
[[nodiscard]] MeshFormat format_of(const std::filesystem::path& path, const FileErrors& errors);

}  // namespace occlod
