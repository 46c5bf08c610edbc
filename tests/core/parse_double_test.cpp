#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <random>
#include <string>
#include <string_view>

#include "base/text.h"

namespace occlod {
namespace {

struct Parsed {
  std::ptrdiff_t length = 0;
  std::errc error{};
  double value = -1.0;
  bool operator==(const Parsed&) const = default;
};

Parsed parse(std::string_view text) {
  Parsed parsed;
  const auto result = parse_double_portably(text.data(), text.data() + text.size(), parsed.value);
  parsed.length = result.ptr - text.data();
  parsed.error = result.ec;
  return parsed;
}

// What the standard demands of std::from_chars: nothing but a minus before the number, no hexadecimal one, as much as
// can be read, and no value when none fits.
TEST(ParseDouble, ReadsWhatTheStandardDemands) {
  EXPECT_EQ(parse("1.5"), (Parsed{3, {}, 1.5}));
  EXPECT_EQ(parse("-.5e1x"), (Parsed{5, {}, -5.0}));
  EXPECT_EQ(parse("5."), (Parsed{2, {}, 5.0}));
  EXPECT_EQ(parse("2e+"), (Parsed{1, {}, 2.0}));
  EXPECT_EQ(parse("0x10"), (Parsed{1, {}, 0.0}));
  EXPECT_EQ(parse("1,5"), (Parsed{1, {}, 1.0}));
  EXPECT_EQ(parse("0e9"), (Parsed{3, {}, 0.0}));
  EXPECT_EQ(parse("INFINITE"), (Parsed{3, {}, HUGE_VAL}));
  EXPECT_TRUE(std::isnan(parse("nan").value));
  for (const char* none : {"", "-", ".", "-.", " 1", "+1", "e5", "in"}) {
    EXPECT_EQ(parse(none), (Parsed{0, std::errc::invalid_argument, -1.0})) << none;
  }
  EXPECT_EQ(parse("-1e400,"), (Parsed{6, std::errc::result_out_of_range, -1.0}));
  EXPECT_EQ(parse("1e-400"), (Parsed{6, std::errc::result_out_of_range, -1.0}));
}

// 17 digits tell every double from its neighbours, the denormalised ones too.
TEST(ParseDouble, ReadsEveryDoubleBack) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 20'000; ++i) {
    const auto value = std::bit_cast<double>(random() >> (i % 2 == 0 ? 0U : 12U));
    if (!std::isfinite(value)) continue;
    char text[40];
    const int size = std::snprintf(text, sizeof(text), "%.17g", value);
    EXPECT_EQ(parse({text, static_cast<std::size_t>(size)}), (Parsed{size, {}, value})) << text;
  }
}

}  // namespace
}  // namespace occlod
