// The same cells on every machine: images of occluders are drawn by vector code, which decides what is asked about.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "raster/every_target.h"
#include "small_cells.h"

namespace occlod {
namespace {

TEST(InstructionSets, GiveTheSameBytes) {
  std::string pattern = (std::filesystem::temp_directory_path() / "occlod-sets-XXXXXX").string();
  const std::filesystem::path folder = mkdtemp(pattern.data());
  const test::SmallCells scene;
  std::string first;
  int sets = 0;
  test::for_every_target([&](const char* target) {
    CellBuild(scene.objects(), test::SmallCells::options()).write(folder / "cells.vlod", 1);
    const std::string bytes = test::bytes_of_file(folder / "cells.vlod");
    if (sets++ == 0) first = bytes;
    EXPECT_TRUE(bytes == first) << target;
  });
  std::filesystem::remove_all(folder);
  EXPECT_GT(sets, 1);
  EXPECT_GT(first.size(), 1000U);
}

}  // namespace
}  // namespace occlod
