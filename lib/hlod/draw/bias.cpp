#include "occlod/traverse/bias.h"

#include <algorithm>

namespace occlod::hlod {
namespace {

// Two parabolas that meet at t with slope 2.
double sigmoid(double mu, double t) {
  return mu <= t && t > 0.0 ? mu * mu / t : 1.0 - (1.0 - mu) * (1.0 - mu) / (1.0 - t);
}

}  // namespace

double Bias::operator()(double mu) const noexcept {
  if (!(mu > 0.0)) return 0.0;
  if (mu >= 1.0) return 1.0;
  return (1.0 - s) * mu + s * sigmoid(mu, t);
}

}  // namespace occlod::hlod
