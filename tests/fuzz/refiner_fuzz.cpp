// The refiner: whatever it is asked for, its meshes are valid and within the budget.
#include <cstdio>
#include <cstdlib>

#include "fuzz/refiner_operations.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  occlod::fuzz::RefinerOperations operations;
  const std::string fault = operations.run(occlod::fuzz::Bytes({data, size}));
  if (!fault.empty()) {
    std::fprintf(stderr, "%s\n", fault.c_str());
    std::abort();
  }
  return 0;
}
