#include "base/parse_double.h"

#include <locale.h>
#include <stdlib.h>
#if __has_include(<xlocale.h>)
#include <xlocale.h>
#endif

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <system_error>

namespace occlod {
namespace {

constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }
constexpr char lower_case(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

const char* skip_digits(const char* at, const char* last) { return std::find_if_not(at, last, is_digit); }

// The end of digits with at most one point, or `first` when there is no digit.
const char* end_of_digits(const char* first, const char* last) {
  const char* const point = skip_digits(first, last);
  if (point == last || *point != '.') return point;
  const char* const end = skip_digits(point + 1, last);
  return end - first > 1 ? end : first;
}

// The end of an exponent, or `first` when there is none.
const char* end_of_exponent(const char* first, const char* last) {
  if (first == last || lower_case(*first) != 'e') return first;
  const char* const digits = last - first > 1 && (first[1] == '-' || first[1] == '+') ? first + 2 : first + 1;
  const char* const end = skip_digits(digits, last);
  return end == digits ? first : end;
}

// The end of what is not finite, or `first`.
const char* end_of_name(const char* first, const char* last) {
  for (const std::string_view name : {"infinity", "inf", "nan"}) {
    const std::string_view text(first, std::min(name.size(), static_cast<std::size_t>(last - first)));
    if (std::ranges::equal(text, name, {}, lower_case)) return first + name.size();
  }
  return first;
}

double to_double(const std::string& number) {
  static const locale_t plain = newlocale(LC_ALL_MASK, "C", nullptr);
  return strtod_l(number.c_str(), nullptr, plain);
}

}  // namespace

std::from_chars_result parse_double_portably(const char* first, const char* last, double& value) {
  const char* const digits = first != last && *first == '-' ? first + 1 : first;
  const char* const mantissa = end_of_digits(digits, last);
  const bool is_finite = mantissa != digits;
  const char* const end = is_finite ? end_of_exponent(mantissa, last) : end_of_name(digits, last);
  if (end == digits) return {first, std::errc::invalid_argument};
  const double parsed = to_double({first, end});
  const bool is_zero = std::none_of(digits, mantissa, [](char c) { return c >= '1' && c <= '9'; });
  if (is_finite && (std::isinf(parsed) || (parsed == 0.0 && !is_zero))) return {end, std::errc::result_out_of_range};
  value = parsed;
  return {end, {}};
}

}  // namespace occlod
