#include "base/atomic_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "io/mesh_files.h"
#include "occlod/mesh_file.h"
#include "support/meshes.h"

namespace occlod {
namespace {

namespace fs = std::filesystem;

TEST(AtomicFile, AppearsOnlyOnCommit) {
  const test::TestFolder folder;
  const fs::path path = folder.write("a.txt", "old");
  {
    AtomicFile file(path);
    file.stream() << "half";
    file.stream().flush();
    EXPECT_EQ(test::bytes_of(path), "old");
  }
  EXPECT_EQ(test::bytes_of(path), "old");
  EXPECT_EQ(test::files_in(folder.path()), 1u);
  {
    AtomicFile file(path);
    file.stream() << "new";
    file.write(std::as_bytes(std::span("er", 2)));
    file.commit();
    EXPECT_EQ(test::bytes_of(path), "newer");
  }
  EXPECT_EQ(test::bytes_of(path), "newer");
  EXPECT_EQ(test::files_in(folder.path()), 1u);
}

TEST(AtomicFile, ReportsAFailedWriteAndKeepsTheOldFile) {
  const test::TestFolder folder;
  const fs::path path = folder.write("a.txt", "old");
  AtomicFile file(path);
  file.stream().setstate(std::ios::badbit);  // as after a full disk
  EXPECT_THROW(file.commit(), Error);
  EXPECT_EQ(test::bytes_of(path), "old");
}

// Of the hidden files beside the target only those go that a process of the same machine, which has ended, left there
// more than a minute ago for the same target. No process has the largest number.
TEST(AtomicFile, RemovesWhatKilledProcessesLeft) {
  const test::TestFolder folder;
  const auto leave = [&](const std::string& name, bool is_old) {
    const fs::path path = folder.write(name, "half");
    if (is_old) fs::last_write_time(path, fs::file_time_type::clock::now() - std::chrono::hours(1));
    return path;
  };
  const std::string ended = "2147483647-0.tmp", at_work = std::to_string(getpid()) + "-77.tmp";
  const fs::path leftover = leave(".a.txt." + ended, true);
  const std::vector<fs::path> others = {leave(".a.txt." + at_work, true), leave(".a.txt.2147483647-1.tmp", false),
                                        leave(".b.txt." + ended, true),   leave(".a.txt.x-0.tmp", true),
                                        leave(".a.txt.2147483647", true), leave(".a.txt.-5-0.tmp", true)};
  AtomicFile file(folder.path() / "a.txt");
  file.commit();
  EXPECT_FALSE(fs::exists(leftover));
  for (const fs::path& other : others) EXPECT_TRUE(fs::exists(other)) << other;
}

TEST(AtomicFile, KeepsPermissionsAndFollowsLinks) {
  const test::TestFolder folder;
  const fs::path path = folder.write("a.txt", "old");
  fs::permissions(path, fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink(path, folder.path() / "link");
  AtomicFile file(folder.path() / "link");
  file.stream() << "new";
  file.commit();
  EXPECT_TRUE(fs::is_symlink(folder.path() / "link"));
  EXPECT_EQ(test::bytes_of(path), "new");
  EXPECT_EQ(fs::status(path).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

// What `write` complains about: "problem". "nothing" where it throws no Error.
template <class Write>
std::string problem_of(const Write& write) {
  try {
    write();
  } catch (const Error& error) {
    EXPECT_FALSE(error.diagnosis().remedy.empty());
    return error.diagnosis().problem;
  }
  return "nothing";
}

std::string hidden_file(const fs::path& folder) {
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (const std::string name = entry.path().filename().string(); name.starts_with('.')) return name;
  return "";
}

// A link may be made before the file that it leads to, here through a second link, in another folder.
TEST(AtomicFile, WritesWhereLinksLead) {
  const test::TestFolder folder;
  fs::create_directory(folder.path() / "other");
  fs::create_symlink("other/second", folder.path() / "link");
  fs::create_symlink("a.txt", folder.path() / "other" / "second");
  EXPECT_EQ(AtomicFile::target_of(folder.path() / "link"), folder.path() / "other" / "a.txt");
  AtomicFile file(folder.path() / "link");
  file.stream() << "new";
  file.commit();
  EXPECT_TRUE(fs::is_symlink(folder.path() / "link"));
  EXPECT_TRUE(fs::is_symlink(folder.path() / "other" / "second"));
  EXPECT_FALSE(fs::is_symlink(folder.path() / "other" / "a.txt"));
  EXPECT_EQ(test::bytes_of(folder.path() / "other" / "a.txt"), "new");
}

TEST(AtomicFile, EveryNameOfAFileHasOneIdentity) {
  const test::TestFolder folder;
  fs::create_directory(folder.path() / "other");
  fs::create_symlink("other/a.txt", folder.path() / "link");
  const fs::path detour = folder.path() / "other" / ".." / "other" / "a.txt";
  for (const bool exists : {false, true}) {
    if (exists) std::ofstream(folder.path() / "other" / "a.txt") << "text";
    EXPECT_EQ(identity_of(folder.path() / "link"), identity_of(folder.path() / "other" / "a.txt")) << exists;
    EXPECT_EQ(identity_of(detour), identity_of(folder.path() / "other" / "a.txt")) << exists;
    EXPECT_NE(identity_of(folder.path() / "link"), identity_of(folder.path() / "other" / "b.txt")) << exists;
  }
  fs::create_hard_link(folder.path() / "other" / "a.txt", folder.path() / "hard");
  EXPECT_EQ(identity_of(folder.path() / "hard"), identity_of(folder.path() / "link"));
  fs::create_symlink("circle", folder.path() / "circle");
  EXPECT_EQ(identity_of(folder.path() / "circle"), identity_of(folder.path() / "circle"));
}

TEST(AtomicFile, RefusesLinksThatLeadNowhere) {
  const test::TestFolder folder;
  fs::create_symlink("circle", folder.path() / "circle");
  fs::create_symlink("missing/a.txt", folder.path() / "astray");
  const std::pair<fs::path, std::string> links[] = {{folder.path() / "circle", "leads back to itself"},
                                                    {folder.path() / "astray", "does not exist"}};
  for (const auto& link : links) {
    EXPECT_CONTAINS(problem_of([&] { AtomicFile file(link.first); }), link.second);
    EXPECT_TRUE(fs::is_symlink(link.first));
  }
}

// 255 bytes is what nearly every file system takes; the hidden neighbour must do with as much. No character of its name
// is cut in two: the second name has two bytes of one at 99 and 100.
TEST(AtomicFile, WritesNamesAsLongAsTheFileSystemTakes) {
  const test::TestFolder folder;
  const std::string a_umlaut = "\xC3\xA4";
  for (const auto& [name, hidden] :
       {std::pair{std::string(255, 'a'), "." + std::string(100, 'a') + "."},
        std::pair{std::string(99, 'b') + a_umlaut + std::string(100, 'b'), "." + std::string(99, 'b') + "."}}) {
    AtomicFile file(folder.path() / name);
    file.stream() << "new";
    EXPECT_EQ(hidden_file(folder.path()).substr(0, hidden.size()), hidden);
    file.commit();
    EXPECT_EQ(test::bytes_of(folder.path() / name), "new");
  }
  EXPECT_EQ(test::files_in(folder.path()), 2u);
  EXPECT_EQ(problem_of([&] { AtomicFile file(folder.path() / std::string(256, 'a')); }), "the name is too long");
}

// Everything that the constructor refuses, with nothing written: not even the time of the folder changes.
TEST(AtomicFile, ChecksWithoutWriting) {
  const test::TestFolder folder;
  const fs::path old = folder.write("a.txt", "old");
  fs::create_symlink("circle", folder.path() / "circle");
  const auto time = fs::last_write_time(folder.path());
  for (const fs::path& path :
       {folder.path(), folder.path() / "", folder.path() / "missing" / "a.txt", fs::path(), folder.path() / "circle",
        folder.path() / std::string(256, 'a'), fs::path("/dev/null")}) {
    const std::string problem = problem_of([&] { AtomicFile::check(path); });
    EXPECT_NE(problem, "nothing") << path;
    EXPECT_EQ(problem, problem_of([&] { AtomicFile file(path); })) << path;
  }
  EXPECT_EQ(problem_of([&] { AtomicFile::check(old); }), "nothing");
  EXPECT_EQ(problem_of([&] { AtomicFile::check(folder.path() / "new.txt"); }), "nothing");
  EXPECT_EQ(fs::last_write_time(folder.path()), time);
  EXPECT_EQ(test::bytes_of(old), "old");
}

// Two blocks' worth of bytes: the monitor sees the file before it is begun, each block and the commit, and counts
// whole.
TEST(WriteMonitor, SeesEveryBlock) {
  const test::TestFolder folder;
  const std::vector<std::byte> bytes((std::size_t{1} << 22) + 1);
  std::vector<std::uint64_t> seen;
  {
    const WriteMonitor monitor([&](std::uint64_t written) {
      EXPECT_EQ(test::files_in(folder.path()), seen.empty() ? 0u : 1u);
      seen.push_back(written);
    });
    AtomicFile file(folder.path() / "a");
    file.write(bytes);
    file.commit();
  }
  AtomicFile unseen(folder.path() / "b");
  EXPECT_EQ(seen, (std::vector<std::uint64_t>{0, 0, bytes.size() - 1, bytes.size()}));
  EXPECT_EQ(test::bytes_of(folder.path() / "a").size(), bytes.size());
}

TEST(WriteMonitor, EndsTheWritingAtAnyPointWithTheOldFileInPlace) {
  const test::TestFolder folder;
  const fs::path path = folder.write("a.ply", "old");
  const TriangleMesh mesh = test::octahedron_sphere(2);
  int calls = 0;
  const WriteMonitor count([&](std::uint64_t) { ++calls; });
  write_mesh(folder.path() / "b.ply", mesh);
  ASSERT_GE(calls, 3);  // begin, one block, commit
  for (int last = 1; last <= calls; ++last) {
    int left = last;
    const WriteMonitor stop([&](std::uint64_t) {
      if (--left == 0) throw std::runtime_error("stop");
    });
    EXPECT_THROW(write_mesh(path, mesh), std::runtime_error);
    EXPECT_EQ(test::bytes_of(path), "old");
    EXPECT_EQ(test::files_in(folder.path()), 2u);
  }
}

void write_text(const fs::path& path, const std::string& text) {
  AtomicFile file(path);
  file.stream() << text;
  file.commit();
}

TEST(FileGroup, AppearsTogetherOnCommit) {
  const test::TestFolder folder;
  const fs::path old = folder.write("old", "1"), fresh = folder.path() / "fresh";
  {
    FileGroup group;
    write_text(old, "2");
    write_text(fresh, "2");
    EXPECT_EQ(test::bytes_of(old), "1");
    EXPECT_FALSE(fs::exists(fresh));
  }
  EXPECT_EQ(test::bytes_of(old), "1");
  EXPECT_EQ(test::files_in(folder.path()), 1u);
  {
    FileGroup outer;
    {
      FileGroup inner;
      write_text(fresh, "3");
      inner.commit();  // left to the outer one
    }
    EXPECT_FALSE(fs::exists(fresh));
    write_text(old, "3");
    write_text(old, "4");
    outer.commit();
  }
  EXPECT_EQ(test::bytes_of(old), "4");
  EXPECT_EQ(test::bytes_of(fresh), "3");
  EXPECT_EQ(test::files_in(folder.path()), 2u);
}

// A folder takes the name of the last file after that has been written.
TEST(FileGroup, LeavesEverythingWhenOneFileCannotBeReplaced) {
  const test::TestFolder folder;
  const fs::path old = folder.write("old", "1"), fresh = folder.path() / "fresh", taken = folder.path() / "taken";
  {
    FileGroup group;
    write_text(old, "2");
    write_text(old, "3");
    write_text(fresh, "3");
    write_text(taken, "3");
    fs::create_directories(taken / "full");
    EXPECT_THROW(group.commit(), Error);
    EXPECT_EQ(test::bytes_of(old), "1");
    EXPECT_FALSE(fs::exists(fresh));
  }
  EXPECT_EQ(test::bytes_of(old), "1");
  EXPECT_TRUE(fs::is_directory(taken / "full"));
  EXPECT_EQ(test::files_in(folder.path()), 2u);
}

TEST(WriteGuard, SeesEachFileBeforeItIsWritten) {
  const test::TestFolder folder;
  std::vector<fs::path> seen;
  const WriteGuard guard([&](const fs::path& path) {
    seen.push_back(path);
    if (path.filename() == "no") throw std::runtime_error("no");
  });
  write_text(folder.path() / "a", "");
  EXPECT_THROW(write_text(folder.path() / "no", ""), std::runtime_error);
  {
    AtomicFolder inside(folder.path() / "b");
    inside.write("c/d", "");
    EXPECT_THROW(inside.write("c/no", ""), std::runtime_error);
  }
  EXPECT_EQ(seen, (std::vector<fs::path>{folder.path() / "a", folder.path() / "no", folder.path() / "b" / "c" / "d",
                                         folder.path() / "b" / "c" / "no"}));
  EXPECT_EQ(test::files_in(folder.path()), 1u);
}

TEST(AtomicFile, RefusesDevices) { EXPECT_THROW(AtomicFile("/dev/null"), Error); }

}  // namespace
}  // namespace occlod
