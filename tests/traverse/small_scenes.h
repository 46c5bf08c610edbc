// Small generated HLODs, and eyes in and around them.
#pragma once

#include <array>
#include <glm/mat4x4.hpp>
#include <random>
#include <vector>

#include "occlod/build_hlod.h"
#include "occlod/mesh.h"
#include "occlod/view.h"
#include "papers/trial_traverser.h"

namespace occlod::hlod::test {

// All but ideal, which draws what another draws.
inline constexpr std::array asking_strategies = {TrialStrategy::sw, TrialStrategy::sw_b, TrialStrategy::boolean,
                                                 TrialStrategy::simp, TrialStrategy::coh};

// Those that come after: whatever is visible counts in full with them, or may.
inline constexpr std::array later_strategies = {TrialStrategy::nohc,     TrialStrategy::optimum,
                                                TrialStrategy::batch,    TrialStrategy::automatic,
                                                TrialStrategy::chc_plus, TrialStrategy::two_pass};

// In nodes of at most 64 triangles on level 0, so of several levels; nested groups have free borders.
[[nodiscard]] Hlod small_hlod(const TriangleMesh& mesh, Grouping grouping);
// Blocks of houses: most of it is hidden from the street.
[[nodiscard]] const Hlod& city(Grouping grouping);
// A rough planet.
[[nodiscard]] const Hlod& planet(Grouping grouping);

// In [low, high), the same with every standard library.
[[nodiscard]] double uniform(std::mt19937_64& random, double low, double high);

// From around the middle of a box out to twice its size, near the plane of its least z, towards a random point in it; z
// is up. 160 x 120 pixels.
[[nodiscard]] Camera random_camera(const Box& box, std::mt19937_64& random);
// All of the HLOD in sight, from somewhere around it. Likewise.
[[nodiscard]] Camera from_afar(const Hlod& hlod, std::mt19937_64& random);
// Step i of a walk of so many steps around the middle of the box at a quarter of its size, along the tangent.
[[nodiscard]] Camera walk(const Box& box, int i, int steps);

}  // namespace occlod::hlod::test
