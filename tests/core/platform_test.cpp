#include "base/platform.h"

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

TEST_F(PlatformFile, JournalsGrowAndAreCut) {
  const auto in_bytes = [](std::string_view added) { return std::as_bytes(std::span(added)); };
  {
    JournalFile file(path());
    EXPECT_EQ(file.size(), content.size());
    file.cut(6);
    file.append(in_bytes("-one"));
    EXPECT_EQ(file.size(), 10U);
    std::array<std::byte, 3> bytes{};
    file.read(bytes, 4);
    EXPECT_EQ(text(bytes), "ty-");
    EXPECT_THROW(file.read(bytes, 8), std::system_error);
  }
  std::array<std::byte, 10> bytes{};
  InputFile(path()).read(bytes);
  EXPECT_EQ(text(bytes), "twenty-one");
  std::filesystem::remove(path());
  JournalFile(path()).append(in_bytes("made"));
  EXPECT_EQ(std::filesystem::file_size(path()), 4U);
}

TEST_F(PlatformFile, OneJournalAtATime) {
  const auto why_no_journal = [](const char* file) {
    try {
      const JournalFile journal(file);
    } catch (const std::system_error& error) {
      return static_cast<std::errc>(error.code().value());
    }
    return std::errc{};
  };
  {
    const JournalFile file(path());
    EXPECT_EQ(why_no_journal(path()), std::errc::resource_unavailable_try_again);
  }
  EXPECT_EQ(why_no_journal(path()), std::errc{});
  EXPECT_EQ(why_no_journal(testing::TempDir().c_str()), std::errc::is_a_directory);
  EXPECT_EQ(why_no_journal("/dev/null"), std::errc::invalid_argument);
  EXPECT_EQ(why_no_journal("no such folder/file"), std::errc::no_such_file_or_directory);
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
