// Recordings: replayed call by call, refused where a call differs, and kept in files.
#include "papers/recorded_device.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <random>

#include "device/small_scenes.h"
#include "occlod/base.h"
#include "papers/trial_devices.h"

namespace occlod::hlod {
namespace {

using namespace test;

// What a program saw that draws what is visible and asks about the rest, where answers decide and so does when they
// come.
struct Seen {
  std::vector<std::uint32_t> counts;
  std::vector<bool> available;
  std::vector<NodeId> drawn;
  std::vector<FrameTimes> times;
};

void expect_same(const Seen& a, const Seen& b) {
  EXPECT_EQ(a.counts, b.counts);
  EXPECT_EQ(a.available, b.available);
  EXPECT_EQ(a.drawn, b.drawn);
  EXPECT_TRUE(a.times == b.times);
}

Camera camera_of(int frame) {
  Camera camera = small_camera();
  camera.eye = {std::sin(0.1 * frame) * 3.0, 0.2, std::cos(0.1 * frame) * 3.0};
  return camera;
}

void run_frame(RenderDevice& device, int frame, Seen& seen) {
  const std::vector<PlacedHlod> placed{{&planet(), glm::dmat4(1.0)}, {&wall(), glm::dmat4(1.0)}};
  device.begin_frame(View(camera_of(frame)), placed);
  draw_finest(device, 1, wall());
  std::vector<QueryId> queries;
  std::vector<BoxRef> boxes;
  for (NodeId n = 0; n < planet().node_count(); n += 3) {
    boxes.push_back({0, planet().node(n).box});
    queries.push_back(device.ask({&boxes.back(), 1}));
    device.visit(1 + n % 2);
  }
  for (std::size_t i = 0; i < queries.size(); ++i) {
    seen.available.push_back(device.available(queries[i]));
    const std::uint32_t count = device.wait(queries[i])[0];
    seen.counts.push_back(count);
    if (count > 0) {
      seen.drawn.push_back(static_cast<NodeId>(3 * i));
      draw_node(device, 0, planet(), static_cast<NodeId>(3 * i));
    }
  }
  const auto each = device.wait(device.ask_each(boxes));
  seen.counts.insert(seen.counts.end(), each.begin(), each.end());
  seen.times.push_back(device.end_frame());
}

struct Recorded {
  Recording recording;
  Seen seen;
};
const Recorded& recorded() {
  static const Recorded result = [] {
    VirtualDevice device(device_preset("modern"));
    RecordingDevice recorder(device);
    Recorded run;
    for (int frame = 0; frame < 5; ++frame) run_frame(recorder, frame, run.seen);
    run.recording = recorder.recording();
    return run;
  }();
  return result;
}

TEST(RecordedDevice, HandsEverythingOn) {
  VirtualDevice device(device_preset("modern"));
  Seen seen;
  for (int frame = 0; frame < 5; ++frame) run_frame(device, frame, seen);
  expect_same(recorded().seen, seen);
  EXPECT_EQ(recorded().recording.device_name(), "virtual:modern");
  EXPECT_EQ(recorded().recording.frame_count(), 5U);
  // The run is worth recording.
  EXPECT_GT(std::count(seen.counts.begin(), seen.counts.end(), 0U), 10);
  EXPECT_GE(std::count(seen.available.begin(), seen.available.end(), true), 5);
  EXPECT_GT(std::count(seen.available.begin(), seen.available.end(), false), 1);
}

TEST(RecordedDevice, ReplaysTheSameRun) {
  ReplayingDevice replay(recorded().recording);
  EXPECT_EQ(replay.name(), "recorded:virtual:modern");
  Seen seen;
  for (int frame = 0; frame < 5; ++frame) run_frame(replay, frame, seen);
  expect_same(seen, recorded().seen);
}

std::string refusal(const std::function<void()>& run) {
  try {
    run();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

// After two good frames.
std::string refusal_in_third_frame(const std::function<void(RenderDevice&)>& run) {
  ReplayingDevice replay(recorded().recording);
  Seen seen;
  run_frame(replay, 0, seen);
  run_frame(replay, 1, seen);
  return refusal([&] { run(replay); });
}

TEST(RecordedDevice, RefusesWhatWasNotRecorded) {
  const std::vector<PlacedHlod> placed{{&planet(), glm::dmat4(1.0)}, {&wall(), glm::dmat4(1.0)}};
  const auto begin = [&](RenderDevice& device) { device.begin_frame(View(camera_of(2)), placed); };
  const std::string remedy = "; replay with the HLODs, the path and the options of the recording";
  EXPECT_EQ(refusal_in_third_frame([&](RenderDevice& device) { device.begin_frame(View(camera_of(3)), placed); }),
            "replay: frame 2, command 0: is told begin_frame in another view or with other HLODs, but begin_frame was "
            "recorded with other arguments" +
                remedy);
  EXPECT_EQ(refusal_in_third_frame([&](RenderDevice& device) { device.visit(1); }),
            "replay: frame 2, command 0: is told visit of 1 nodes, but begin_frame was recorded" + remedy);
  EXPECT_EQ(
      refusal_in_third_frame([&](RenderDevice& device) {
        begin(device);
        draw_finest(device, 0, wall());
      }),
      "replay: frame 2, command 1: is told draw of node 0 of object 0, but draw was recorded with other arguments" +
          remedy);
  EXPECT_EQ(refusal_in_third_frame([&](RenderDevice& device) {
              begin(device);
              draw_finest(device, 1, wall());
              const BoxRef boxes[2]{};
              (void)device.ask_each(boxes);
            }),
            "replay: frame 2, command 2: is told ask_each about 2 boxes, but ask was recorded" + remedy);
  EXPECT_EQ(refusal_in_third_frame([&](RenderDevice& device) {
              begin(device);
              (void)device.wait(7);
            }),
            "replay: frame 2, command 1: is told wait for query 7, but draw was recorded" + remedy);
  EXPECT_NE(refusal_in_third_frame([&](RenderDevice& device) {
              begin(device);
              (void)device.end_frame();
            }),
            "");
  ReplayingDevice replay(recorded().recording);
  Seen seen;
  for (int frame = 0; frame < 5; ++frame) run_frame(replay, frame, seen);
  EXPECT_EQ(
      refusal([&] { run_frame(replay, 5, seen); }),
      "replay: frame 5, command 0: is told begin_frame in another view or with other HLODs, but only 5 frames were "
      "recorded" +
          remedy);
}

// One bit of an argument is enough.
TEST(RecordedDevice, RefusesTheSlightestDifference) {
  const std::vector<PlacedHlod> placed{{&planet(), glm::dmat4(1.0)}};
  const auto run = [&](RenderDevice& device, const std::vector<PlacedHlod>& objects, const Camera& camera,
                       const DrawRange& range, const BoxRef& box) {
    device.begin_frame(View(camera), objects);
    device.draw({0, 1, {&range, 1}});
    (void)device.ask({&box, 1});
    device.end_frame();
  };
  const DrawRange range{0, 30, 0.5F};
  const BoxRef box{0, planet().node(1).box};
  SoftwareDevice software;
  RecordingDevice recorder(software);
  run(recorder, placed, small_camera(), range, box);
  const auto refused = [&](const std::vector<PlacedHlod>& objects, const Camera& camera, const DrawRange& drawn,
                           const BoxRef& asked) {
    ReplayingDevice replay(recorder.recording());
    return !refusal([&] { run(replay, objects, camera, drawn, asked); }).empty();
  };
  EXPECT_FALSE(refused(placed, small_camera(), range, box));
  Camera camera = small_camera();
  camera.eye.x = std::numeric_limits<double>::denorm_min();
  EXPECT_TRUE(refused(placed, camera, range, box));
  camera = small_camera();
  camera.orthographic_height = 1.0;
  EXPECT_TRUE(refused(placed, camera, range, box));
  std::vector<PlacedHlod> moved = placed;
  moved[0].object_to_world[3].x = 1e-300;
  EXPECT_TRUE(refused(moved, small_camera(), range, box));
  moved = placed;
  moved[0].two_sided = true;
  EXPECT_TRUE(refused(moved, small_camera(), range, box));
  EXPECT_TRUE(refused({{&wall(), glm::dmat4(1.0)}}, small_camera(), range, box));
  EXPECT_TRUE(refused({placed[0], placed[0]}, small_camera(), range, box));
  EXPECT_TRUE(refused(placed, small_camera(), {0, 30, std::nextafter(0.5F, 1.0F)}, box));
  EXPECT_TRUE(refused(placed, small_camera(), {3, 30, 0.5F}, box));
  BoxRef other = box;
  other.box.max.z = std::nextafter(other.box.max.z, 1e9F);
  EXPECT_TRUE(refused(placed, small_camera(), range, other));
}

// What an exception has left in the middle is not recorded; the next frame is whole again.
TEST(RecordedDevice, KeepsWholeFramesOnly) {
  SoftwareDevice software;
  RecordingDevice recorder(software);
  Seen seen;
  run_frame(recorder, 0, seen);
  const std::size_t commands = recorder.recording().command_count();
  const PlacedHlod placed{&planet(), glm::dmat4(1.0)};
  recorder.begin_frame(View(small_camera()), {&placed, 1});
  (void)count_of(recorder, {0, planet().node(0).box});
  EXPECT_EQ(recorder.recording().command_count(), commands);
  run_frame(recorder, 1, seen);
  EXPECT_EQ(recorder.recording().frame_count(), 2U);
  ReplayingDevice replay(recorder.recording());
  Seen again;
  run_frame(replay, 0, again);
  run_frame(replay, 1, again);
  expect_same(again, seen);
}

// ---- Files.

class RecordingFile : public testing::Test {
 protected:
  RecordingFile() {
    folder_ = std::filesystem::path(testing::TempDir()) /
              (std::string("occlod_recording_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
    write_recording(folder_ / "good", recorded().recording);
    std::ifstream stream(folder_ / "good", std::ios::binary);
    good_ = {std::istreambuf_iterator<char>(stream), {}};
  }
  ~RecordingFile() override { std::filesystem::remove_all(folder_); }

  // What reading these bytes is refused with.
  [[nodiscard]] std::string refusal_of(const std::string& bytes) const {
    std::ofstream(folder_ / "changed", std::ios::binary) << bytes;
    return refusal([&] { (void)read_recording(folder_ / "changed"); });
  }
  // Of a file with good checksums whose content has been changed.
  [[nodiscard]] std::string refusal_of_lie(const std::function<void(RecordingData&)>& lie) const {
    RecordingData data = *recorded().recording.data();
    lie(data);
    write_recording(folder_ / "lie", Recording(std::make_shared<const RecordingData>(data)));
    return refusal([&] { (void)read_recording(folder_ / "lie"); });
  }

  std::filesystem::path folder_;
  std::string good_;
};

TEST_F(RecordingFile, ComesBack) {
  const Recording read = read_recording(folder_ / "good");
  EXPECT_EQ(read.device_name(), "virtual:modern");
  ReplayingDevice replay(read);
  Seen seen;
  for (int frame = 0; frame < 5; ++frame) run_frame(replay, frame, seen);
  expect_same(seen, recorded().seen);
  write_recording(folder_ / "again", read);
  std::ifstream stream(folder_ / "again", std::ios::binary);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(stream), {}), good_);
  write_recording(folder_ / "empty", Recording());
  EXPECT_EQ(read_recording(folder_ / "empty").frame_count(), 0U);
}

TEST_F(RecordingFile, EveryTruncationIsRefused) {
  for (std::size_t size = 0; size < good_.size(); size += size < 300 ? 1 : 97)
    EXPECT_NE(refusal_of(good_.substr(0, size)), "") << size << " bytes";
  EXPECT_NE(refusal_of(good_ + "x").find("truncated or has extra bytes"), std::string::npos);
}

TEST_F(RecordingFile, EveryFlippedBitIsRefused) {
  // But for padding between sections, which nothing reads: less than 64 bytes before each of 4 sections.
  std::mt19937 random(3);
  int unseen = 0;
  for (int n = 0; n < 600; ++n) {
    std::string bad = good_;
    const std::size_t at = n < 300 ? static_cast<std::size_t>(n) : random() % bad.size();
    bad[at] = static_cast<char>(bad[at] ^ (1 << (random() % 8)));
    if (refusal_of(bad).empty()) ++unseen;
  }
  EXPECT_LT(unseen, 64);
}

TEST_F(RecordingFile, SaysWhatIsWrong) {
  EXPECT_NE(refusal([&] { (void)read_recording(folder_ / "missing"); }).find("cannot be opened"), std::string::npos);
  EXPECT_EQ(refusal_of("ply\n"), (folder_ / "changed").string() + ": byte 0: is not an .orec file; record one");
  std::string damaged = good_;
  damaged[good_.size() / 2] = static_cast<char>(damaged[good_.size() / 2] ^ 1);
  EXPECT_NE(refusal_of(damaged).find("checksum is wrong; record it again"), std::string::npos);
}

TEST_F(RecordingFile, ContradictionsAreRefused) {
  const auto first = [](RecordingData& data, Call call) -> RecordedCall& {
    return *std::find_if(data.calls.begin(), data.calls.end(), [&](const RecordedCall& c) { return c.call == call; });
  };
  EXPECT_EQ(refusal_of_lie([](RecordingData&) {}), "");
  const std::vector<std::pair<const char*, std::function<void(RecordingData&)>>> lies{
      {"is none", [](RecordingData& data) { data.calls[3].call = static_cast<Call>(8); }},
      {"is none", [](RecordingData& data) { data.calls[3].reserved = 1; }},
      {"wrong side", [](RecordingData& data) { data.calls[0].call = Call::draw; }},
      {"wrong side", [](RecordingData& data) { data.calls[3].call = Call::begin_frame; }},
      {"no end", [](RecordingData& data) { data.calls.pop_back(); }},
      {"counts", [](RecordingData& data) { data.counts.pop_back(); }},
      {"counts", [](RecordingData& data) { data.counts.push_back(0); }},
      {"times", [](RecordingData& data) { data.times.pop_back(); }},
      {"not finite", [](RecordingData& data) { data.times[1].cpu_ms = std::numeric_limits<double>::infinity(); }},
      {"one count", [&](RecordingData& data) { first(data, Call::ask).count = 2; }},
      {"waits for what", [&](RecordingData& data) { first(data, Call::wait).count = 0; }},
      {"waits for what", [&](RecordingData& data) { first(data, Call::wait).count = 0xffffffffU; }},
      {"waits for what", [&](RecordingData& data) { first(data, Call::wait).query = 4000; }},
      {"waits for what", [&](RecordingData& data) { first(data, Call::ask_each).count = 3; }},
      {"neither", [&](RecordingData& data) { first(data, Call::available).count = 2; }},
      {"neither", [&](RecordingData& data) { first(data, Call::available).query = 4000; }},
      {"taken", [&](RecordingData& data) { first(data, Call::ask_each).query = 0; }},
      {"has an answer", [&](RecordingData& data) { first(data, Call::draw).count = 1; }},
  };
  for (const auto& [what, lie] : lies) {
    const std::string line = refusal_of_lie(lie);
    EXPECT_NE(line.find("does not hold a valid recording: "), std::string::npos) << what;
    EXPECT_NE(line.find(what), std::string::npos) << line;
  }
}

}  // namespace
}  // namespace occlod::hlod
