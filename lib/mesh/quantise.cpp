#include "occlod/mesh/quantise.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace occlod {

float lattice_step(const Box& box, int bits) {
  double extent = 0.0, farthest = 0.0;
  for (int k = 0; k < 3; ++k) {
    extent = std::max(extent, double{box.max[k]} - double{box.min[k]});
    farthest = std::max({farthest, std::abs(double{box.min[k]}), std::abs(double{box.max[k]})});
  }
  if (!(extent > 0.0)) return 0.0F;
  int exponent = 0;
  const double mantissa = std::frexp(std::ldexp(extent, -bits), &exponent);  // in [0.5, 1)
  if (mantissa == 0.5) --exponent;
  const int of_floats = std::ilogb(farthest) - (std::numeric_limits<float>::digits - 1);
  return static_cast<float>(
      std::ldexp(1.0, std::max({exponent, of_floats, std::numeric_limits<float>::min_exponent - 1})));
}

glm::vec3 round_to_lattice(const glm::vec3& p, float step) {
  if (!(step > 0.0F)) return p;
  glm::vec3 rounded;
  for (int k = 0; k < 3; ++k) rounded[k] = std::nearbyint(p[k] / step) * step + 0.0F;  // no negative zero
  return rounded;
}

void round_to_lattice(TriangleMesh& mesh, float step) {
  for (glm::vec3& p : mesh.positions) p = round_to_lattice(p, step);
}

}  // namespace occlod
