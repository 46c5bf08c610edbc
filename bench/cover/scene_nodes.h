// The same of our scenes: nodes of an HLOD along a camera path, drawn front to back.
#pragma once

#include <filesystem>
#include <string>

#include "cover/cover_counts.h"

namespace occlod::bench {

struct SceneNodesOptions {
  std::filesystem::path scene;  // whose camera path is taken
  std::filesystem::path hlod;   // of the scene
  std::string path;
  int frames = 0;             // spread evenly over the path; 0: all
  double tolerance_px = 1.0;  // to which nodes are refined
};

// Counts the box of every node that is reached, inner ones too, against what was drawn of the nodes nearer to the eye;
// those around the eye or beside the image are left out. All nodes are drawn, hidden ones too, as ellipsoids are.
// Throws Error for files that cannot be read, a path that the scene lacks, or no scene.
void count_scene_nodes(const SceneNodesOptions& options, CoverCounts& counts);

}  // namespace occlod::bench
