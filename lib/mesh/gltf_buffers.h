// The buffers that a glTF file names.
#pragma once

#include <string>
#include <string_view>

namespace occlod {

// A glTF file, text or binary, that EXT_meshopt_compression is used in may name buffers that are nowhere: they would
// hold what the extension decodes. tinygltf refuses those. Returns the file with one byte in place of each, kept in
// `patched`; any other file as it is.
[[nodiscard]] std::string_view with_missing_buffers(std::string_view bytes, std::string& patched);

// The JSON text of a glTF file, text or binary; empty of a binary file that is cut off.
[[nodiscard]] std::string_view gltf_text(std::string_view bytes);

}  // namespace occlod
