// One hierarchy, read or built once, is used by any number of threads at a time.
#include <gtest/gtest.h>

#include <filesystem>
#include <thread>
#include <vector>

#include "occlod/build_hierarchy.h"
#include "occlod/generate.h"
#include "occlod/visibility.h"
#include "refine/refine_support.h"

namespace occlod {
namespace {

std::uint64_t refined_hash(const Hierarchy& hierarchy) {
  Refiner refiner(std::vector<RefineObject>{{&hierarchy, glm::dmat4(1.0), false}});
  RefineOptions options;
  options.budget = 4000;
  return refiner.refine(View(test::front_camera()), options, *make_software_occlusion()).hash();
}

TEST(SharedHierarchy, ThreadsRefineOneFileThatIsCheckedAsItIsUsed) {
  // Some 16 blocks of splits, none of them checked yet when the threads begin; each thread needs nearly all of them.
  const std::filesystem::path path = std::filesystem::path(::testing::TempDir()) / "occlod_shared_hierarchy.olod";
  const Hierarchy built = build_hierarchy(generate("rough-planet", {{"level", 6}}));
  write_olod(path, built, {});
  for (int round = 0; round < 3; ++round) {
    const OlodFile file = read_olod(path);
    std::vector<std::uint64_t> hashes(4);
    std::vector<std::thread> threads;
    for (std::uint64_t& hash : hashes) threads.emplace_back([&] { hash = refined_hash(file.hierarchy); });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(hashes, std::vector<std::uint64_t>(4, refined_hash(built)));
  }
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace occlod
