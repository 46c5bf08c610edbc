#include <gtest/gtest.h>
#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <iostream>
#include <random>
#include <string>
#include <vector>

#include "fuzz/refiner_operations.h"

namespace occlod {
namespace {

std::vector<std::uint8_t> random_bytes(unsigned seed) {
  std::mt19937 random(seed);
  std::vector<std::uint8_t> bytes(1000);
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
  return bytes;
}

// The operations of the fuzzer with random bytes: some 2,000 calls of refine() and update() with options, budgets,
// backends and cameras that change in between, each of them checked against the definitions.
TEST(RandomOperations, MeshesAreValidWhateverIsAskedFor) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    fuzz::RefinerOperations operations;
    ASSERT_EQ(operations.run(fuzz::Bytes(random_bytes(seed))), "") << seed;
  }
}

double heap_mb() { return static_cast<double>(mallinfo2().uordblks + mallinfo2().hblkhd) / 1e6; }

// One refiner for all, with OCCLOD_SOAK_S for so many seconds and a line of numbers every 500 runs. Its memory grows to
// what the largest budget, picture and front need, and then no more: budgets, pictures and hierarchies are bounded.
TEST(RandomOperations, MemoryStays) {
  const char* wanted = std::getenv("OCCLOD_SOAK_S");
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(wanted != nullptr ? std::atoi(wanted) : 0);
  constexpr unsigned first_runs = 20;
  fuzz::RefinerOperations operations;
  double largest_at_first = 0.0, largest = 0.0;
  for (unsigned seed = 1; seed <= 2 * first_runs || std::chrono::steady_clock::now() < end; ++seed) {
    ASSERT_EQ(operations.run(fuzz::Bytes(random_bytes(seed))), "") << seed;
    double& seen = seed <= first_runs ? largest_at_first : largest;
    seen = std::max(seen, heap_mb());
    if (wanted != nullptr && seed % 500 == 0)
      std::cout << seed << " runs of " << fuzz::RefinerOperations::max_operations << " operations: " << heap_mb()
                << " MB, at most " << largest << std::endl;
  }
  EXPECT_LT(largest, 1.1 * largest_at_first + 1.0);
}

}  // namespace
}  // namespace occlod
