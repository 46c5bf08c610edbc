// A PNG that another reader opens, or none.
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#include <gtest/gtest.h>
#include <stb_image.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "occlod/base.h"
#include "occlod/picture.h"

namespace occlod {
namespace {

class WritePng : public testing::Test {
 protected:
  WritePng() { std::filesystem::create_directories(folder_); }
  ~WritePng() override { std::filesystem::remove_all(folder_); }

  static Image random_image(int width, int height, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_int_distribution<int> byte(0, 255);
    Image image{width, height, {}};
    for (int i = 0; i < width * height; ++i)
      image.pixels.emplace_back(byte(random), byte(random), byte(random), byte(random));
    return image;
  }

  static std::vector<glm::u8vec4> read(const std::filesystem::path& path, int& width, int& height) {
    int channels = 0;
    const std::unique_ptr<stbi_uc, void (*)(void*)> bytes(stbi_load(path.c_str(), &width, &height, &channels, 4),
                                                          stbi_image_free);
    if (!bytes) return {};
    std::vector<glm::u8vec4> pixels;
    for (int i = 0; i < width * height; ++i)
      pixels.emplace_back(bytes.get()[4 * i], bytes.get()[4 * i + 1], bytes.get()[4 * i + 2], bytes.get()[4 * i + 3]);
    return pixels;
  }

  std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) /
      (std::string("occlod_png_") + testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(WritePng, IsReadBackAsItWas) {
  for (const auto& [width, height] : {std::pair{1, 1}, {3, 2}, {64, 48}, {101, 7}}) {
    const Image image = random_image(width, height, 1);
    write_png(folder_ / "a.png", image);  // over the one before
    int read_width = 0, read_height = 0;
    EXPECT_EQ(read(folder_ / "a.png", read_width, read_height), image.pixels);
    EXPECT_EQ(read_width, width);
    EXPECT_EQ(read_height, height);
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);  // no temporary is left
}

TEST_F(WritePng, NamesTheFileThatCannotBeWritten) {
  const std::filesystem::path missing = folder_ / "missing" / "a.png";
  try {
    write_png(missing, random_image(2, 2, 1));
    FAIL() << "wrote into a folder that does not exist";
  } catch (const Error& error) {
    EXPECT_EQ(error.diagnosis().subject, missing.string());
  }
}

TEST_F(WritePng, LeavesNothingBehindWhenItFails) {
  // A folder cannot be replaced by a file.
  std::filesystem::create_directories(folder_ / "a.png" / "inside");
  EXPECT_THROW(write_png(folder_ / "a.png", random_image(2, 2, 1)), Error);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "a.png" / "inside"));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
}

}  // namespace
}  // namespace occlod
