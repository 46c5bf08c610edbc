#include "hlod/tiles/geodetic.h"

#include <cmath>

namespace occlod::tiles {
namespace {

// The sine and cosine of an angle, exact at multiples of 90 degrees.
struct Direction {
  double sine;
  double cosine;
};

Direction direction_of(double degrees) {
  constexpr double radians = 0.017453292519943295;
  if (std::fmod(degrees, 180.0) == 0.0) return {0.0, std::fmod(degrees, 360.0) == 0.0 ? 1.0 : -1.0};
  if (std::fmod(degrees, 90.0) == 0.0) return {degrees > 0.0 ? 1.0 : -1.0, 0.0};  // -90 or 90
  return {std::sin(degrees * radians), std::cos(degrees * radians)};
}

}  // namespace

glm::dmat4 east_north_up(const GeodeticOrigin& origin) {
  constexpr double equator = 6378137.0, flattening = 1.0 / 298.257223563;  // WGS84
  constexpr double squared_eccentricity = flattening * (2.0 - flattening);
  const Direction longitude = direction_of(origin.longitude_deg), latitude = direction_of(origin.latitude_deg);
  const glm::dvec3 east(-longitude.sine, longitude.cosine, 0.0);
  const glm::dvec3 north(-latitude.sine * longitude.cosine, -latitude.sine * longitude.sine, latitude.cosine);
  const glm::dvec3 up(latitude.cosine * longitude.cosine, latitude.cosine * longitude.sine, latitude.sine);
  // Of the normal, from the surface to the axis.
  const double radius = equator / std::sqrt(1.0 - squared_eccentricity * latitude.sine * latitude.sine);
  const glm::dvec3 place((radius + origin.height_m) * up.x, (radius + origin.height_m) * up.y,
                         (radius * (1.0 - squared_eccentricity) + origin.height_m) * up.z);
  return {glm::dvec4(east, 0.0), glm::dvec4(north, 0.0), glm::dvec4(up, 0.0), glm::dvec4(place, 1.0)};
}

}  // namespace occlod::tiles
