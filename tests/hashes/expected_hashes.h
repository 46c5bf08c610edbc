// The hashes of tests/hashes/expected.txt.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iomanip>
#include <map>
#include <sstream>
#include <string>

namespace occlod::test {

// Lines of a name and a hash, with comments that begin with '#'.
class ExpectedHashes {
 public:
  explicit ExpectedHashes(std::string file) : file_(std::move(file)) {
    std::ifstream lines(file_);
    for (std::string line; std::getline(lines, line);) {
      if (line.empty() || line.front() == '#') {
        comments_ += line + '\n';
        continue;
      }
      std::istringstream words(line);
      std::string name;
      std::uint64_t hash = 0;
      words >> name >> std::hex >> hash;
      hashes_[name] = hash;
    }
  }

  // Compares a hash with the expected one, or writes it down when OCCLOD_UPDATE_HASHES is set. `where` is the
  // instruction set or the number of threads that gave it.
  void compare(const std::string& name, std::uint64_t hash, const std::string& where) {
    seen_[name] = hash;
    if (std::getenv("OCCLOD_UPDATE_HASHES") != nullptr && first_.emplace(name, hash).second) hashes_[name] = hash;
    const auto expected = hashes_.find(name);
    if (expected == hashes_.end())
      ADD_FAILURE() << name << " is not in " << file_ << ": write it with OCCLOD_UPDATE_HASHES=1";
    else
      EXPECT_EQ(hash, expected->second) << name << ", " << where;
  }

  // The last call: every expected name has been seen. Rewrites the file when OCCLOD_UPDATE_HASHES is set.
  void finish() const {
    for (const auto& [name, hash] : hashes_)
      EXPECT_TRUE(seen_.contains(name)) << name << " is in " << file_ << " and nowhere else";
    if (std::getenv("OCCLOD_UPDATE_HASHES") == nullptr) return;
    std::ofstream lines(file_);
    lines << comments_ << std::hex << std::setfill('0');
    for (const auto& [name, hash] : seen_) lines << name << ' ' << std::setw(16) << hash << '\n';
  }

 private:
  std::string file_;
  std::string comments_;
  std::map<std::string, std::uint64_t> hashes_, seen_, first_;
};

}  // namespace occlod::test
