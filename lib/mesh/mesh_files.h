// Names of mesh files: the format that a name stands for, and the files that a mesh file refers to.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/file_input.h"

namespace occlod {

enum class MeshFormat { ply, obj, off, stl, gltf };

// Returns the format that the extension stands for, in upper or lower case, or nothing.
[[nodiscard]] std::optional<MeshFormat> find_format(const std::filesystem::path& path);
// Returns the format that the extension stands for, in upper or lower case. Throws Error for any other extension.
[[nodiscard]] MeshFormat format_of(const std::filesystem::path& path, const FileErrors& errors);

// Returns the bytes of a glTF file, text or binary, so that tinygltf accepts them. A file with EXT_meshopt_compression
// may name buffers without data, which stand for what the extension decodes; each of them gets one byte, in a copy of
// the file in `patched`. Any other file is returned as it is.
[[nodiscard]] std::string_view with_missing_buffers(std::string_view bytes, std::string& patched);

// Returns the JSON text of a glTF file, text or binary; empty for a binary file that is cut short.
[[nodiscard]] std::string_view gltf_text(std::string_view bytes);

// Returns the existing files whose contents belong to the mesh, in the order of their names in the file: material
// libraries of OBJ and buffers of glTF, but no images. Returns nothing for a damaged file or another format. Throws
// Error for a file that cannot be read. O(size).
[[nodiscard]] std::vector<std::filesystem::path> files_beside(const std::filesystem::path& mesh);

// Returns the existing image files that the mesh names: in the material libraries of OBJ, the header of PLY, and glTF.
// May return files that it names otherwise, since a blank may be part of a name or follow it. Returns nothing for a
// damaged file or another format. Throws Error for a file that cannot be read. O(size).
[[nodiscard]] std::vector<std::filesystem::path> images_of(const std::filesystem::path& mesh);

// Returns a name of a file as it is where the folder has that file, or with slashes instead of the backslashes of
// Windows. A backslash may also be the second byte of a Chinese or Japanese character, or stand in the name of a file
// that was unpacked as one.
[[nodiscard]] std::string name_in(const std::filesystem::path& folder, std::string_view name);

// Returns the names on a mtllib line of files that exist in the folder: the whole line as one name, or
// word by word.
[[nodiscard]] std::vector<std::string> library_names(std::string_view line, const std::filesystem::path& folder);

// Returns a URI as a file name, with escapes such as %20 decoded.
[[nodiscard]] std::string file_name_of_uri(std::string_view uri);

}  // namespace occlod
