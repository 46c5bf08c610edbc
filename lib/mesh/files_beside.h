// Files that a mesh file names.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace occlod {

// Those whose contents belong to the mesh, in the order of their names in the file, as far as they exist: libraries of
// materials of OBJ and buffers of glTF, not pictures. None of a file that is damaged, or of another format. Throws
// Error for a file that cannot be read. O(size).
[[nodiscard]] std::vector<std::filesystem::path> files_beside(const std::filesystem::path& mesh);

// The names on a mtllib line, with slashes, of files that exist in the folder: the whole line, or word by word.
[[nodiscard]] std::vector<std::string> library_names(std::string_view line, const std::filesystem::path& folder);

// A URI with %20 and the like as the name of a file.
[[nodiscard]] std::string file_name_of_uri(std::string_view uri);

}  // namespace occlod
