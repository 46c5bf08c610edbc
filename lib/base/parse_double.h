// std::from_chars for decimal fractions, which libc++ before 20 does not have.
#pragma once

#include <charconv>
#include <version>

namespace occlod {

// The same, from strtod.
[[nodiscard]] std::from_chars_result parse_double_portably(const char* first, const char* last, double& value);

[[nodiscard]] inline std::from_chars_result parse_double(const char* first, const char* last, double& value) {
#if defined(__cpp_lib_to_chars)
  return std::from_chars(first, last, value);
#else
  return parse_double_portably(first, last, value);
#endif
}

}  // namespace occlod
