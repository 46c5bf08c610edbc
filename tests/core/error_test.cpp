#include <gtest/gtest.h>

#include "occlod/base.h"

namespace occlod {
namespace {

TEST(Error, SaysFilePlaceProblemAndMendInOneLine) {
  const Error error({"a.ply", "line 3", "is not a number", "export it again"});
  EXPECT_STREQ(error.what(), "a.ply: line 3: is not a number; export it again");
  EXPECT_EQ(error.diagnosis().place, "line 3");
}

TEST(Error, LeavesOutWhatIsEmpty) { EXPECT_STREQ(Error({"a.ply", "", "is empty", ""}).what(), "a.ply: is empty"); }

}  // namespace
}  // namespace occlod
