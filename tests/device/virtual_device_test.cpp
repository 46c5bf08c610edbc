// Frame times of sequences of commands, added up by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>

#include "device/small_scenes.h"
#include "hlod/draw/node_images.h"
#include "hlod/draw/software_drawing.h"
#include "hlod/draw/virtual_clock.h"
#include "occlod/base.h"
#include "papers/trial_devices.h"

namespace occlod::hlod {
namespace {

using namespace test;

constexpr double ms = 1e6;  // ns

// The wall is one draw; `behind` is hidden by it.
const BoxRef behind{0, {{-0.2F, -0.2F, -1.2F}, {0.2F, 0.2F, -0.8F}}};
const BoxRef unknown{0, {{-0.2F, -0.2F, 2.8F}, {0.2F, 0.2F, 3.2F}}};

// A frame of the wall.
struct Frame {
  explicit Frame(const DeviceCosts& costs) : device(costs) {
    const PlacedHlod placed{&wall(), glm::dmat4(1.0)};
    device.begin_frame(View(small_camera()), {&placed, 1});
  }
  void draw() { draw_finest(device, 0, wall()); }
  QueryId ask() { return device.ask({&behind, 1}); }

  VirtualDevice device;
};

void expect_times(const FrameTimes& times, const FrameTimes& expected) {
  EXPECT_DOUBLE_EQ(times.frame_ms, expected.frame_ms);
  EXPECT_DOUBLE_EQ(times.cpu_ms, expected.cpu_ms);
  EXPECT_DOUBLE_EQ(times.gpu_ms, expected.gpu_ms);
  EXPECT_DOUBLE_EQ(times.stall_ms, expected.stall_ms);
  EXPECT_DOUBLE_EQ(times.starve_ms, expected.starve_ms);
}

// Nothing costs anything but that an answer is there 1 ms after its query: it is waited for from 0 to 1, and the second
// draw starts then.
TEST(VirtualDevice, OneQueryOfOneMillisecondBetweenTwoDrawsStallsForOne) {
  Frame frame({.name = "test", .readback_ns = ms});
  frame.draw();
  const QueryId query = frame.ask();
  EXPECT_FALSE(frame.device.available(query));
  EXPECT_EQ(frame.device.wait(query)[0], 0U);
  EXPECT_TRUE(frame.device.available(query));
  frame.draw();
  const FrameTimes times = frame.device.end_frame();
  EXPECT_EQ(times.stall_ms, 1.0);
  expect_times(times, {.frame_ms = 1.0, .cpu_ms = 1.0, .gpu_ms = 0.0, .stall_ms = 1.0, .starve_ms = 1.0});
}

// draw 2, query 1, readback 0.5, submit 0.25:
//   c 0.25  draw   [0.25, 2.25]
//   c 0.5   query  [2.25, 3.25], readable at 3.75
//   c 3.75  waited 3.25
//   c 4     draw   [4, 6], after a gap of 0.75
TEST(VirtualDevice, WaitingStallsTheProcessorAndStarvesTheDevice) {
  Frame frame({.name = "test", .draw_ns = 2 * ms, .query_ns = ms, .readback_ns = 0.5 * ms, .submit_ns = 0.25 * ms});
  frame.draw();
  (void)frame.device.wait(frame.ask());
  frame.draw();
  expect_times(frame.device.end_frame(),
               {.frame_ms = 6.0, .cpu_ms = 4.0, .gpu_ms = 5.0, .stall_ms = 3.25, .starve_ms = 0.75});
}

// The same without waiting: two more draws and three visits are given meanwhile.
//   c 0.25  draw [0.25, 2.25];  c 0.5 query [2.25, 3.25], readable at 3.75
//   c 0.75  draw [3.25, 5.25];  c 1 draw [5.25, 7.25];  c 4 after three visits of 1: available
TEST(VirtualDevice, WhoHasOtherWorkDoesNotWait) {
  Frame frame({.name = "test",
               .draw_ns = 2 * ms,
               .query_ns = ms,
               .readback_ns = 0.5 * ms,
               .submit_ns = 0.25 * ms,
               .visit_ns = ms});
  frame.draw();
  const QueryId query = frame.ask();
  frame.draw();
  frame.draw();
  frame.device.visit(2);
  EXPECT_FALSE(frame.device.available(query));  // 3
  frame.device.visit(1);
  EXPECT_TRUE(frame.device.available(query));
  (void)frame.device.wait(query);
  expect_times(frame.device.end_frame(),
               {.frame_ms = 7.25, .cpu_ms = 4.0, .gpu_ms = 7.0, .stall_ms = 0.0, .starve_ms = 0.0});
}

// The slowest stage decides: set-up, 128 triangles, or the fragments of the wall.
TEST(VirtualDevice, ADrawTakesAsLongAsItsSlowestStage) {
  const auto gpu_ms = [](const DeviceCosts& costs) {
    Frame frame(costs);
    frame.draw();
    return frame.device.end_frame().gpu_ms;
  };
  SoftwareDevice software;
  const PlacedHlod placed{&wall(), glm::dmat4(1.0)};
  software.begin_frame(View(small_camera()), {&placed, 1});
  draw_finest(software, 0, wall());
  const auto fragments = static_cast<double>(software.work().fragments);
  EXPECT_GT(fragments, 1000.0);
  EXPECT_DOUBLE_EQ(gpu_ms({.draw_ns = 200, .triangle_ns = 1, .fragment_ns = 0.01}), 200e-6);
  EXPECT_DOUBLE_EQ(gpu_ms({.draw_ns = 100, .triangle_ns = 1, .fragment_ns = 0.01}), 128e-6);
  EXPECT_DOUBLE_EQ(gpu_ms({.draw_ns = 100, .triangle_ns = 1, .fragment_ns = 3}), 3 * fragments * 1e-6);
}

// Likewise queries, of one box or of several, and batches. Hidden or not, what a box covers costs.
TEST(VirtualDevice, QueriesTakeAsLongAsTheirSlowestStage) {
  const auto gpu_ms = [](const DeviceCosts& costs, std::span<const BoxRef> boxes, bool batch) {
    Frame frame(costs);
    (void)(batch ? frame.device.ask_each(boxes) : frame.device.ask(boxes));
    EXPECT_EQ(frame.device.software().work().boxes, boxes.size());
    return frame.device.end_frame().gpu_ms;
  };
  Frame counting({.name = "count"});
  const double covered = counting.device.wait(counting.ask())[0];  // on an empty screen
  EXPECT_GT(covered, 20.0);
  const std::vector<BoxRef> one{behind}, three{behind, behind, behind};
  const DeviceCosts costs{
      .triangle_ns = 1, .query_ns = 100, .query_fragment_ns = 0.5, .batch_ns = 1000, .batch_item_ns = 10};
  DeviceCosts no_fragments = costs, dear_fragments = costs, dear_triangles = costs;
  no_fragments.query_fragment_ns = 0.0;
  dear_fragments.query_fragment_ns = 1000.0;
  dear_triangles.triangle_ns = 1e6;
  EXPECT_DOUBLE_EQ(gpu_ms(no_fragments, one, false), 100e-6);
  EXPECT_DOUBLE_EQ(gpu_ms(no_fragments, three, false), 100e-6);  // one query, 36 triangles
  EXPECT_DOUBLE_EQ(gpu_ms(dear_fragments, one, false), covered * 1e-3);
  EXPECT_DOUBLE_EQ(gpu_ms(dear_fragments, three, false), 3 * covered * 1e-3);
  EXPECT_DOUBLE_EQ(gpu_ms(dear_triangles, three, false), 36.0);
  EXPECT_DOUBLE_EQ(gpu_ms(no_fragments, one, true), 1010e-6);
  EXPECT_DOUBLE_EQ(gpu_ms(no_fragments, three, true), 1030e-6);
  EXPECT_DOUBLE_EQ(gpu_ms(dear_fragments, three, true), 3 * covered * 1e-3);
}

// Nothing is drawn for them, so there is no command to wait for.
TEST(VirtualDevice, BoxesThatAreNotDrawnCostNothing) {
  Frame frame({.name = "test", .query_ns = ms, .readback_ns = ms, .batch_ns = ms, .submit_ns = ms});
  const BoxRef beside{0, cube({100.0F, 0.0F, 0.0F}, 1.0F)};
  for (const BoxRef& box : {unknown, beside}) {
    const QueryId query = frame.device.ask({&box, 1}), batch = frame.device.ask_each({&box, 1});
    EXPECT_TRUE(frame.device.available(query));
    EXPECT_TRUE(frame.device.available(batch));
    EXPECT_EQ(frame.device.wait(query)[0], frame.device.wait(batch)[0]);
  }
  expect_times(frame.device.end_frame(), {});
}

// Latency in commands: there after three more, however long they take, or when it is waited for.
TEST(VirtualDevice, AnswersComeAfterSoManyCommands) {
  Frame frame({.name = "test", .latency_commands = 3});
  const QueryId first = frame.ask(), second = frame.ask();
  frame.draw();
  EXPECT_FALSE(frame.device.available(first));
  frame.device.visit(100);  // no command
  EXPECT_FALSE(frame.device.available(first));
  frame.draw();
  EXPECT_TRUE(frame.device.available(first));
  EXPECT_FALSE(frame.device.available(second));
  (void)frame.device.wait(second);
  EXPECT_TRUE(frame.device.available(second));
  expect_times(frame.device.end_frame(), {});
}

TEST(VirtualDevice, EachFrameStartsAtZero) {
  Frame frame({.name = "test", .draw_ns = ms, .readback_ns = ms});
  frame.draw();
  (void)frame.device.wait(frame.ask());
  const FrameTimes first = frame.device.end_frame();
  const PlacedHlod placed{&wall(), glm::dmat4(1.0)};
  frame.device.begin_frame(View(small_camera()), {&placed, 1});
  frame.draw();
  (void)frame.device.wait(frame.ask());
  expect_times(frame.device.end_frame(), first);
  EXPECT_DOUBLE_EQ(first.frame_ms, 2.0);
}

// With the answers of the software device, whatever they cost.
TEST(VirtualDevice, CountsAsTheSoftwareDeviceDoes) {
  SoftwareDevice software;
  VirtualDevice device(device_preset("query-dear"));
  const PlacedHlod placed{&planet(), glm::dmat4(1.0)};
  for (RenderDevice* each : std::initializer_list<RenderDevice*>{&software, &device}) {
    each->begin_frame(View(small_camera()), {&placed, 1});
    draw_finest(*each, 0, planet());
  }
  for (NodeId n = 0; n < planet().node_count(); ++n)
    EXPECT_EQ(count_of(device, {0, planet().node(n).box}), count_of(software, {0, planet().node(n).box}));
  EXPECT_EQ(device.software().depth().nearness, software.depth().nearness);
  EXPECT_EQ(device.name(), "virtual:query-dear");
}

// What a device takes from another is what it would draw itself: in this view, of these ranges, and nothing of the last
// view.
TEST(VirtualDevice, SharesWhatNodesLookLike) {
  const auto images = std::make_shared<NodeImages>();
  VirtualDevice first(device_preset("modern"), images), second(device_preset("query-dear"), images);
  const PlacedHlod placed{&planet(), glm::dmat4(1.0)};
  Camera camera = small_camera();
  for (const double x : {0.0, 0.4}) {
    camera.eye.x = x;
    for (VirtualDevice* shared : {&first, &second, &first}) {
      SoftwareDevice alone;
      for (RenderDevice* each : std::initializer_list<RenderDevice*>{shared, &alone}) {
        each->begin_frame(View(camera), {&placed, 1});
        const DrawRange part{0, shared == &second ? 3U : 6U};  // of a node of which another device draws another part
        each->draw({.object = 0, .node = 0, .ranges = {&part, 1}});
        if (shared != &second) draw_finest(*each, 0, planet());
      }
      EXPECT_EQ(shared->software().depth().nearness, alone.depth().nearness);
      EXPECT_EQ(shared->software().work().triangles, alone.work().triangles);
      EXPECT_EQ(shared->software().work().fragments, alone.work().fragments);
      for (NodeId n = 0; n < planet().node_count(); n += 7)
        EXPECT_EQ(count_of(*shared, {0, planet().node(n).box}), count_of(alone, {0, planet().node(n).box}));
    }
  }
}

TEST(VirtualClock, StartsCommandsWhenBothAreReady) {
  VirtualClock clock;
  clock.work(5.0);
  EXPECT_EQ(clock.command(1.0, 10.0), 16.0);  // nothing to do before the first is no starvation
  EXPECT_EQ(clock.command(1.0, 10.0), 26.0);  // queued behind it
  clock.work(93.0);
  EXPECT_EQ(clock.command(0.0, 1.0), 101.0);  // given at 100, idle since 26
  clock.wait_until(50.0);                     // long past
  EXPECT_EQ(clock.cpu_ns(), 100.0);
  clock.wait_until(103.0);
  EXPECT_EQ(clock.commands(), 3U);
  expect_times(clock.times(),
               {.frame_ms = 103e-6, .cpu_ms = 103e-6, .gpu_ms = 21e-6, .stall_ms = 3e-6, .starve_ms = 74e-6});
}

TEST(DeviceCosts, PresetsAreFoundByName) {
  for (const char* name : {"query-cheap", "query-dear", "fill-bound", "modern"})
    EXPECT_EQ(device_preset(name).name, name);
  EXPECT_EQ(device_presets().size(), 4U);
  try {
    (void)device_preset("quick");
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(
        error.what(),
        "virtual device: preset 'quick': is none of query-cheap, query-dear, fill-bound, modern; choose one of "
        "them");
  }
}

// Every cost of a preset says something: a device without it is another one.
TEST(DeviceCosts, AreRefusedWhereTheyAreNoTimes) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  for (double DeviceCosts::*cost :
       {&DeviceCosts::draw_ns, &DeviceCosts::triangle_ns, &DeviceCosts::fragment_ns, &DeviceCosts::query_ns,
        &DeviceCosts::query_fragment_ns, &DeviceCosts::readback_ns, &DeviceCosts::batch_ns, &DeviceCosts::batch_item_ns,
        &DeviceCosts::submit_ns, &DeviceCosts::visit_ns}) {
    for (const DeviceCosts& preset : device_presets()) EXPECT_GT(preset.*cost, 0.0);
    for (const double bad : {-1.0, nan, infinity}) {
      DeviceCosts costs;
      costs.*cost = bad;
      EXPECT_THROW(VirtualDevice{costs}, Error);
    }
  }
}

}  // namespace
}  // namespace occlod::hlod
