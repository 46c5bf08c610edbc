// The stories on real devices: what they answer decides the same. Like tests/device/conformance_test.cpp it is for
// whoever defines tested_devices().
#include <gtest/gtest.h>

#include "device/tested_devices.h"
#include "support/traversal_stories.h"

namespace occlod::hlod {
namespace {

using test::TestedDevice;

class StoriesOnDevices : public testing::TestWithParam<TestedDevice> {};

INSTANTIATE_TEST_SUITE_P(Devices, StoriesOnDevices, testing::ValuesIn(test::tested_devices()),
                         [](const auto& param) { return param.param.label; });

TEST_P(StoriesOnDevices, AreTheSame) {
  std::string why;
  const std::unique_ptr<RenderDevice> device = GetParam().make(why);
  if (!device) GTEST_SKIP() << "SKIPPED: " << GetParam().label << ": " << why;
  occlod::test::PromptDevice prompt(*device);
  for (const occlod::test::Story& story : occlod::test::stories()) occlod::test::expect_story(story, prompt, false);
}

}  // namespace
}  // namespace occlod::hlod
