#include "report/measures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/timing.h"

namespace occlod::bench {
namespace {

template <typename Change>
double mean_after(const std::vector<double>& values, const Change& change) {
  double sum = 0.0;
  for (const double value : values) sum += change(value);
  return sum / static_cast<double>(values.size());
}

}  // namespace

double mean_of(Mean mean, std::span<const double> values) {
  std::vector<double> numbers;
  std::copy_if(values.begin(), values.end(), std::back_inserter(numbers), [](double x) { return !std::isnan(x); });
  if (numbers.empty()) return std::numeric_limits<double>::quiet_NaN();
  switch (mean) {
    case Mean::square:
      return std::sqrt(mean_after(numbers, [](double x) { return x * x; }));
    case Mean::decibel:
      return -10.0 * std::log10(mean_after(numbers, [](double x) { return std::pow(10.0, -x / 10.0); }));
    case Mean::middle:
      return median(numbers);
    case Mean::arithmetic:
      break;
  }
  return mean_after(numbers, [](double x) { return x; });
}

Measured mean_of(std::span<const Measured> pictures) {
  Measured result{};
  for (std::size_t m = 0; m < measures.size(); ++m) {
    std::vector<double> values;
    for (const Measured& picture : pictures) values.push_back(picture[m]);
    result[m] = mean_of(measures[m].mean, values);
  }
  return result;
}

tool::Json number(double value) { return std::isfinite(value) ? tool::Json(value) : tool::Json(); }

}  // namespace occlod::bench
