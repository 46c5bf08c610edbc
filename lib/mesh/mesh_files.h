// Which mesh format a file name stands for.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/file_input.h"

namespace occlod {

enum class MeshFormat { ply, obj, off, stl, gltf };

// By the extension, case ignored; none for any other.
[[nodiscard]] std::optional<MeshFormat> find_format(const std::filesystem::path& path);
// The same. Throws Error for any other.
[[nodiscard]] MeshFormat format_of(const std::filesystem::path& path, const FileErrors& errors);

// The buffers that a glTF file names.

// A glTF file, text or binary, that EXT_meshopt_compression is used in may name buffers that are nowhere: they would
// hold what the extension decodes. tinygltf refuses those. Returns the file with one byte in place of each, kept in
// `patched`; any other file as it is.
[[nodiscard]] std::string_view with_missing_buffers(std::string_view bytes, std::string& patched);

// The JSON text of a glTF file, text or binary; empty of a binary file that is cut off.
[[nodiscard]] std::string_view gltf_text(std::string_view bytes);

// Files that a mesh file names.

// Those whose contents belong to the mesh, in the order of their names in the file, as far as they exist: libraries of
// materials of OBJ and buffers of glTF, not pictures. None of a file that is damaged, or of another format. Throws
// Error for a file that cannot be read. O(size).
[[nodiscard]] std::vector<std::filesystem::path> files_beside(const std::filesystem::path& mesh);

// The names on a mtllib line, with slashes, of files that exist in the folder: the whole line, or word by word.
[[nodiscard]] std::vector<std::string> library_names(std::string_view line, const std::filesystem::path& folder);

// A URI with %20 and the like as the name of a file.
[[nodiscard]] std::string file_name_of_uri(std::string_view uri);

}  // namespace occlod
