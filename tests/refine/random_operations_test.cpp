#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "fuzz/refiner_operations.h"

namespace occlod {
namespace {

// The operations of the fuzzer with random bytes: some 2,000 calls of refine() and update() with options, budgets,
// backends and cameras that change in between, each of them checked against the definitions.
TEST(RandomOperations, MeshesAreValidWhateverIsAskedFor) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    std::vector<std::uint8_t> bytes(1000);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    fuzz::RefinerOperations operations;
    ASSERT_EQ(operations.run(fuzz::Bytes(bytes)), "") << seed;
  }
}

}  // namespace
}  // namespace occlod
