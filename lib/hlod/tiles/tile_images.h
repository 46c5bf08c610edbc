// The images of a tileset's textures: files that its contents share.
#pragma once

#include <string>
#include <vector>

#include "base/atomic_folder.h"
#include "occlod/hlod/hlod.h"
#include "hlod/tiles/encode_tile.h"

namespace occlod::tiles {

// Writes each image once, in the folder textures/. Those that are not there or neither PNG nor JPEG, which is all that
// glTF knows, are left out and named in `left_out`. `image_folder`: what names of files are relative to. O(bytes).
[[nodiscard]] TileLook write_images(AtomicFolder& folder, const hlod::HlodView& hlod,
                                    const std::filesystem::path& image_folder, std::vector<std::string>& left_out);

}  // namespace occlod::tiles
