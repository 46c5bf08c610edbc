#include "arguments.h"

namespace occlod::viewer {
namespace {

double share_or_middle(const JsonPlace& action, std::string_view key) {
  const auto place = action.find(key);
  if (!place) return 0.5;
  const double value = place->number();
  if (!(value >= 0.0 && value <= 1.0)) place->fail("is not between 0 and 1");
  return value;
}

}  // namespace

glm::dvec3 vector_at(const JsonPlace& action, std::string_view key) {
  const std::vector<double> numbers = action.at(key).numbers(3);
  return {numbers[0], numbers[1], numbers[2]};
}

double number_or(const JsonPlace& action, std::string_view key, double value) {
  const auto place = action.find(key);
  return place ? place->number() : value;
}

glm::dvec2 place_of(const JsonPlace& action) { return {share_or_middle(action, "x"), share_or_middle(action, "y")}; }

}  // namespace occlod::viewer
