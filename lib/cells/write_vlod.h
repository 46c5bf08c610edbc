// Writes .vlod files.
#pragma once

#include <filesystem>

#include "cells/cell_subtree.h"
#include "cells/vlod_format.h"

namespace occlod {

// `tree`: finished. Throws Error that names the file.
void write_vlod(const std::filesystem::path& path, const vlod::Scene& scene, const CellSubtree& tree);

}  // namespace occlod
