#include "core/platform.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>

namespace occlod {
namespace {

constexpr std::string_view content = "twenty-one bytes here";

// A file that lasts as long as its test.
class PlatformFile : public testing::Test {
 protected:
  PlatformFile() { std::ofstream(path_) << content; }
  ~PlatformFile() override { std::filesystem::remove(path_); }
  PlatformFile(const PlatformFile&) = delete;
  PlatformFile& operator=(const PlatformFile&) = delete;

  [[nodiscard]] const char* path() const { return path_.c_str(); }

 private:
  std::string path_ = testing::TempDir() + "platform_test." + std::to_string(process_id());
};

std::string_view text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::errc why_not(const char* path) {
  try {
    const InputFile file(path);
  } catch (const std::system_error& error) {
    return static_cast<std::errc>(error.code().value());
  }
  return {};
}

TEST_F(PlatformFile, ReadsFromTheBeginningEachTime) {
  const InputFile file(path());
  EXPECT_EQ(file.size(), content.size());
  for (int time = 0; time < 2; ++time) {
    std::array<std::byte, 6> bytes{};
    file.read(bytes);
    EXPECT_EQ(text(bytes), "twenty");
  }
}

TEST_F(PlatformFile, FailsWhereItHasBecomeShorter) {
  const InputFile file(path());
  std::filesystem::resize_file(path(), 5);
  std::array<std::byte, content.size()> bytes{};
  EXPECT_THROW(file.read(bytes), std::system_error);
}

TEST_F(PlatformFile, MappingOutlivesTheFile) {
  std::span<const std::byte> bytes;
  {
    const InputFile file(path());
    bytes = file.map();
  }
  std::filesystem::remove(path());
  EXPECT_EQ(text(bytes), content);
  unmap(bytes);
}

TEST_F(PlatformFile, OnlyRegularFilesAreOpened) {
  EXPECT_EQ(why_not(path()), std::errc{});
  EXPECT_EQ(why_not(testing::TempDir().c_str()), std::errc::is_a_directory);
  EXPECT_EQ(why_not("/dev/null"), std::errc::invalid_argument);
  EXPECT_EQ(why_not("no such file"), std::errc::no_such_file_or_directory);
}

TEST(Platform, KnowsWhereFilesCanBeMade) {
  EXPECT_EQ(why_no_files_can_be_made(testing::TempDir().c_str()), 0);
  EXPECT_EQ(why_no_files_can_be_made("no such folder"), ENOENT);
}

TEST(Platform, KnowsWhichProcessesAreGone) {
  EXPECT_TRUE(may_be_running(process_id()));
  EXPECT_TRUE(may_be_running(1));  // of another user, perhaps: then a signal is refused, which says that it is there
  const pid_t child = fork();
  if (child == 0) _exit(0);
  ASSERT_EQ(waitpid(child, nullptr, 0), child);
  EXPECT_FALSE(may_be_running(child));  // its number is not given away again at once
}

}  // namespace
}  // namespace occlod
