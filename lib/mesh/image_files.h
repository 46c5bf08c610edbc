// Image files that materials name: where they are, what they hold, and their names when a mesh moves to another folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/memory.h"
#include "occlod/mesh.h"

namespace occlod {

// The folder that names of images are relative to, before and after a mesh moves.
struct ImageFolders {
  std::filesystem::path from;  // empty: names stay as they are
  std::filesystem::path to;
};

// Returns the folder of a file; "." for a name without one.
[[nodiscard]] std::filesystem::path folder_of(const std::filesystem::path& file);

// Returns the path of an image file, whose name may have the backslashes of Windows.
[[nodiscard]] std::filesystem::path image_path(const std::string& file, const std::filesystem::path& folder);

// Returns the name that leads from folders.to to an image file that is found from folders.from. Any other name stays.
[[nodiscard]] std::string name_that_leads(const std::string& file, const ImageFolders& folders);
// Replaces the names of files by those that lead to them.
void lead_to_images(std::vector<Texture>& textures, const ImageFolders& folders);

// An encoded image, in large memory (base/memory.h).
using ImageBytes = LargeVector<std::uint8_t>;

// Returns what the texture holds, or what its file holds; nothing when that cannot be read.
[[nodiscard]] std::optional<ImageBytes> read_image(const Texture& texture, const std::filesystem::path& folder);

// The same for a file that is found by its name, or by its name without the first folders: that leads from where the
// mesh has been written since, while the folder may be that where it was read.
[[nodiscard]] std::optional<ImageBytes> find_image(const Texture& texture, const std::filesystem::path& folder);

// Returns the name of a texture's file, or `image N` of one that the mesh holds.
[[nodiscard]] std::string name_of_image(std::span<const Texture> textures, TextureId id);

// Returns the MIME type that the first bytes of an image tell, else that of its name's extension: image/png,
// image/jpeg, image/webp, image/ktx2, image/vnd-ms.dds, image/avif, image/bmp, image/gif or image/x-tga; else
// application/octet-stream.
[[nodiscard]] std::string image_type(std::span<const std::uint8_t> bytes, const std::string& file = {});

// Returns the MIME type of the image that a texture holds: what its bytes tell, else what the mesh's file said.
[[nodiscard]] std::string image_type(const Texture& texture);

// Returns the extension of files of a MIME type: .png, .jpg, ..., .bin.
[[nodiscard]] std::string image_extension(const std::string& mime_type);

// Returns the glTF extension that images of a type need; empty for PNG and JPEG, and nothing for what glTF lacks.
[[nodiscard]] std::optional<std::string> gltf_image_extension(const std::string& mime_type);

}  // namespace occlod
