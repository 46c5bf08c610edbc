#include <gtest/gtest.h>

#include <cstddef>
#include <cstring>

#include "base/memory.h"

namespace occlod {
namespace {

constexpr std::size_t mebibyte = std::size_t{1} << 20U;

TEST(LargeMemory, IsUsedAgainWhileThatIsWanted) {
  void* large = nullptr;
  {
    const LargeMemoryReuse reuse;
    large = allocate_large(32 * mebibyte);
    void* const small = allocate_large(16 * mebibyte);
    free_large(large, 32 * mebibyte);
    free_large(small, 16 * mebibyte);
    void* const fits = allocate_large(12 * mebibyte);
    EXPECT_EQ(fits, small) << "the smallest that is large enough";
    void* const next = allocate_large(12 * mebibyte);
    EXPECT_EQ(next, large);
    std::memset(next, 1, 12 * mebibyte);
    void* const other = allocate_large(40 * mebibyte);
    EXPECT_NE(other, large);
    free_large(other, 40 * mebibyte);
    free_large(fits, 12 * mebibyte);
    large = next;
  }
  free_large(large, 12 * mebibyte);  // may outlive it
}

TEST(LargeMemory, UninitializedElementsAreNotTouched) {
  struct Counted {
    int value = 3;
  };
  UninitializedVector<Counted> values;
  values.reserve(2);
  values.push_back({7});
  values.pop_back();
  values.resize(1);
  EXPECT_EQ(values[0].value, 7);
  values.resize(2, {5});
  EXPECT_EQ(values[1].value, 5);
}

}  // namespace
}  // namespace occlod
