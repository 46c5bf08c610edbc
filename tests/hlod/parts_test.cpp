// Builds whose groups are simplified elsewhere.
#include "hlod/build/parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "base/platform.h"
#include "build_story.h"
#include "hlod/build/build_journal.h"
#include "hlod_bytes.h"
#include "occlod/base.h"
#include "occlod/build_hlod.h"
#include "occlod/generate.h"
#include "support/meshes.h"
#include "support/wedge_meshes.h"

namespace occlod::hlod {
namespace {

namespace fs = std::filesystem;

// The first level has more groups than are sampled, so it is shared.
std::vector<Story> stories() {
  return {story("shifted", occlod::test::noisy_sphere(6, 1)),
          story("nested", occlod::test::noisy_sphere(5, 2), [](HlodBuildOptions& o) { o.grouping = Grouping::nested; }),
          story("free", occlod::test::noisy_sphere(5, 3),
                [](HlodBuildOptions& o) {
                  o.grouping = Grouping::nested;
                  o.borders = Borders::free;
                }),
          story("splits", occlod::test::noisy_sphere(5, 4), [](HlodBuildOptions& o) { o.within = Within::splits; }),
          story("measured", occlod::test::noisy_sphere(5, 5),
                [](HlodBuildOptions& o) { o.error_bound = ErrorBound::measured; }),
          story("charts", occlod::test::cube_of_charts(40)),
          story("charts with splits", occlod::test::cube_of_charts(30),
                [](HlodBuildOptions& o) { o.within = Within::splits; })};
}

class Parts : public testing::Test {
 protected:
  Parts() { make_folder(); }
  ~Parts() override { fs::remove_all(folder_); }
  Parts(const Parts&) = delete;
  Parts& operator=(const Parts&) = delete;

  void make_folder() const {
    fs::remove_all(folder_);
    fs::create_directory(folder_);
  }
  [[nodiscard]] const fs::path& folder() const { return folder_; }
  [[nodiscard]] std::set<fs::path> files(const std::string& extension) const {
    std::set<fs::path> result;
    for (const auto& entry : fs::directory_iterator(folder_))
      if (entry.path().extension() == extension) result.insert(entry.path());
    return result;
  }

  // The bytes of the HLOD. started() are the tasks of this build; each is simplified when the build waits for it.
  std::string build(const Story& story, std::function<void(const fs::path&)> finish = {}) {
    started_.clear();
    HlodBuildOptions options = story.options;
    options.journal = folder_ / "journal";
    options.parts = {folder_, [&](const fs::path& task) { started_.push_back(task); },
                     finish ? std::move(finish) : [](const fs::path& task) { simplify_part(task, 1); }};
    return test::bytes_of(build_hlod(story.mesh, options));
  }
  [[nodiscard]] const std::vector<fs::path>& started() const { return started_; }

 private:
  fs::path folder_ = testing::TempDir() + "parts_test." + std::to_string(process_id());
  std::vector<fs::path> started_;
};

std::string content_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

void write(const fs::path& file, const std::string& content) { std::ofstream(file, std::ios::binary) << content; }

std::string failure_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST_F(Parts, GiveTheBytesOfOneProcess) {
  for (const Story& story : stories()) {
    SCOPED_TRACE(story.name);
    const std::string plain = test::bytes_of(build_hlod(story.mesh, story.options));
    EXPECT_EQ(build(story), plain);
    EXPECT_GT(started().size(), 2U) << "more than 32 groups, in tasks of 16";
    EXPECT_EQ(files(".task").size() + files(".nodes").size(), 0U) << "all were joined";
    EXPECT_EQ(build(story), plain);
    EXPECT_EQ(started().size(), 0U) << "the journal has them";
    make_folder();
  }
}

// Results come before, after, and long before they are waited for.
TEST_F(Parts, MayComeInAnyOrder) {
  const Story story = stories()[5];
  const std::string plain = test::bytes_of(build_hlod(story.mesh, story.options));
  std::size_t finished = 0;
  const auto all_that_wait = [&](const fs::path& task) {
    ++finished;
    const std::set<fs::path> tasks = files(".task");
    EXPECT_TRUE(tasks.contains(task));
    for (auto other = tasks.rbegin(); other != tasks.rend(); ++other) simplify_part(*other, 2);
  };
  EXPECT_EQ(build(story, all_that_wait), plain);
  EXPECT_EQ(finished, started().size()) << "each is waited for once";
  make_folder();
  HlodBuildOptions options = story.options;
  options.parts = {folder(), [](const fs::path& task) { simplify_part(task, 1); }, [](const fs::path&) {}};
  EXPECT_EQ(test::bytes_of(build_hlod(story.mesh, options)), plain) << "without a journal";
}

// A build ends while it waits for its k-th task, when some of those after it have been simplified.
TEST_F(Parts, ResultsOfABuildThatEndedAreTakenOver) {
  const Story story = stories()[0];
  const std::string plain = test::bytes_of(build_hlod(story.mesh, story.options));
  (void)build(story);
  const std::size_t all = started().size();
  for (const std::size_t k : {std::size_t{0}, std::size_t{1}, std::size_t{17}, all / 2, all - 1}) {
    make_folder();
    std::size_t calls = 0, simplified = 0;
    EXPECT_THROW((void)build(story,
                             [&](const fs::path& task) {
                               if (calls++ < k) return simplify_part(task, 1);
                               for (const fs::path& other : files(".task"))
                                 if (other != task && simplified < 5) {
                                   simplify_part(other, 1);
                                   ++simplified;
                                 }
                               throw std::runtime_error("the end");
                             }),
                 std::runtime_error);
    EXPECT_EQ(build(story), plain);
    EXPECT_EQ(started().size(), all - k - simplified) << "those that were simplified are not again";
  }
}

TEST_F(Parts, DamagedResultsAreMadeAgain) {
  const Story story = stories()[5];
  const std::string plain = test::bytes_of(build_hlod(story.mesh, story.options));
  const auto simplify_all_and_end = [&](const fs::path&) {
    for (const fs::path& task : files(".task")) simplify_part(task, 2);
    throw std::runtime_error("the end");
  };
  EXPECT_THROW((void)build(story, simplify_all_and_end), std::runtime_error);
  std::vector<fs::path> results;
  std::ranges::copy(files(".nodes"), std::back_inserter(results));
  ASSERT_GT(results.size(), 10U);
  std::string damaged = content_of(results[0]);
  damaged[damaged.size() / 2] = static_cast<char>(damaged[damaged.size() / 2] ^ 1);
  write(results[0], damaged);
  write(results[1], content_of(results[1]).substr(0, 100));
  write(results[2], content_of(results[3]));  // of other groups
  write(results[4], "");
  std::string older = content_of(results[5]);
  older[8] = 'x';  // of another version
  write(results[5], older);
  EXPECT_EQ(build(story), plain);
  std::set<fs::path> again;
  for (const fs::path& task : started())
    if (std::ranges::find(results, result_of(task)) != results.end()) again.insert(result_of(task));
  EXPECT_EQ(again, (std::set<fs::path>{results[0], results[1], results[2], results[4], results[5]}));
}

TEST_F(Parts, OfOtherOptionsAreNotTaken) {
  Story story = stories()[0];
  const auto simplify_all_and_end = [&](const fs::path&) {
    for (const fs::path& task : files(".task")) simplify_part(task, 2);
    throw std::runtime_error("the end");
  };
  EXPECT_THROW((void)build(story, simplify_all_and_end), std::runtime_error);
  fs::remove(folder() / "journal");
  story.options.error_bound = ErrorBound::measured;
  const std::string plain = test::bytes_of(build_hlod(story.mesh, story.options));
  EXPECT_EQ(build(story), plain);
}

TEST_F(Parts, AResultThatIsNotSeenIsTold) {
  const std::string told = failure_of([&] { (void)build(stories()[0], [](const fs::path&) {}); });
  EXPECT_EQ(told, (folder() / "level-1-0.nodes").string() +
                      ": is not there or not whole, though its groups were simplified; name a folder that all machines "
                      "see");
}

TEST_F(Parts, TasksAreCheckedAndDoneOnce) {
  EXPECT_THROW((void)build(stories()[0], [](const fs::path&) { throw std::runtime_error("the end"); }),
               std::runtime_error);
  const fs::path task = folder() / "level-1-0.task", result = folder() / "level-1-0.nodes";
  simplify_part(task, 2);
  const auto time = fs::last_write_time(result);
  const std::string bytes = content_of(result);
  simplify_part(task, 1);
  EXPECT_EQ(fs::last_write_time(result), time);
  fs::remove(result);
  simplify_part(task, 1);
  EXPECT_EQ(content_of(result), bytes);
  const std::string whole = content_of(task);
  std::string damaged = whole;
  damaged[whole.size() / 2] = static_cast<char>(damaged[whole.size() / 2] ^ 4);
  for (const std::string& content : {damaged, whole.substr(0, 50), whole.substr(0, whole.size() - 1), bytes}) {
    write(task, content);
    EXPECT_EQ(failure_of([&] { simplify_part(task); }),
              task.string() +
                  ": is no undamaged task of an HLOD build of this version of occlod; use the same version on all "
                  "machines");
  }
  EXPECT_NE(failure_of([&] { simplify_part(folder() / "none.task"); }), "");
}

}  // namespace
}  // namespace occlod::hlod
