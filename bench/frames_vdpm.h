// The table of bench_frames that needs OpenMesh.
#pragma once

namespace occlod::bench {

// Refinement on OpenMesh's VDPM pieces and ours, view by view in turns, around the rough planet of level 8.
void compare_with_vdpm();

}  // namespace occlod::bench
