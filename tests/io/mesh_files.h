// Files that a test writes and reads again.
#pragma once

#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>

#include "occlod/base.h"
#include "occlod/mesh_file.h"

namespace occlod::test {

// What run() says about bad bytes of the file `subject`: "place: problem". "accepted" where it does not refuse them.
template <typename Run>
[[nodiscard]] std::string complaint_of(const std::filesystem::path& subject, const Run& run) {
  try {
    run();
  } catch (const Error& error) {
    EXPECT_EQ(error.diagnosis().subject, subject.string());
    EXPECT_FALSE(error.diagnosis().remedy.empty());
    EXPECT_EQ(std::string_view(error.what()).find('\n'), std::string_view::npos);
    return error.diagnosis().place + ": " + error.diagnosis().problem;
  }
  return "accepted";
}

// A folder of its own for the running test, removed at the end.
class TestFolder {
 public:
  TestFolder() {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::path(testing::TempDir()) /
            (std::string("occlod-") + info->test_suite_name() + "-" + info->name());
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~TestFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::filesystem::path write(const std::string& name, std::string_view bytes) const {
    std::ofstream(path_ / name, std::ios::binary) << bytes;
    return path_ / name;
  }
  [[nodiscard]] CleanMesh read(const std::string& name, std::string_view bytes) const {
    return read_mesh(write(name, bytes));
  }
  // The same of the reader.
  [[nodiscard]] std::string complaint(const std::string& name, std::string_view bytes) const {
    const std::filesystem::path path = write(name, bytes);
    return complaint_of(path, [&] { static_cast<void>(read_mesh(path)); });
  }

 private:
  std::filesystem::path path_;
};

[[nodiscard]] inline std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

[[nodiscard]] inline std::size_t files_in(const std::filesystem::path& folder) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

// Appends numbers to a binary file image in the given byte order.
class Bytes {
 public:
  explicit Bytes(std::string text = {}, std::endian order = std::endian::little)
      : bytes_(std::move(text)), order_(order) {}

  template <class Number>
  Bytes& add(Number value) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    const std::string image(raw, sizeof value);
    bytes_ += order_ == std::endian::native ? image : std::string(image.rbegin(), image.rend());
    return *this;
  }
  Bytes& add_point(float x, float y, float z) { return add(x).add(y).add(z); }
  [[nodiscard]] const std::string& str() const { return bytes_; }

 private:
  std::string bytes_;
  std::endian order_;
};

// "contains", with the whole text in the message of a failure.
#define EXPECT_CONTAINS(text, part) EXPECT_NE(std::string(text).find(part), std::string::npos) << "in: " << (text)

}  // namespace occlod::test
