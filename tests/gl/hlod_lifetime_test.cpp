// Memory, several devices and contexts, what others leave behind, and contexts that are lost, for the device `gl`.
#include <array>
#include <glm/ext/matrix_transform.hpp>
#include <limits>
#include <random>

#include "gl/backends.h"
#include "gl/hlod_cases.h"
#include "gl/losing_context.h"
#include "gl/mesh_arena.h"
#include "occlod/base.h"
#include "occlod/build_hlod.h"
#include "support/meshes.h"

namespace occlod::gl {
namespace {

class HlodLifetime : public EachHlodDevice {
 protected:
  void SetUp() override {
    EachHlodDevice::SetUp();
    view_ = sphere_view();
  }
  void begin(HlodDevice& device, const hlod::Hlod& hlod) const {
    const std::array<hlod::PlacedHlod, 1> objects{{{&hlod}}};
    device.begin_frame(view_, objects);
  }
  // The whole of a level.
  [[nodiscard]] Image picture(HlodDevice& device, const hlod::Hlod& hlod, std::uint32_t level,
                              float morph = 0.0F) const {
    begin(device, hlod);
    draw_level(device, hlod, level, morph);
    static_cast<void>(device.end_frame());
    return device.read_image();
  }
};
INSTANTIATE_TEST_SUITE_P(Gl, HlodLifetime, testing::ValuesIn(tested_devices()), device_label);

// Room for few meshes at a time: most leave within the frame that drew them, and the picture is the same.
TEST_P(HlodLifetime, LittleMemoryGivesTheSamePicture) {
  const auto large = make();
  const auto small = make(32 * 1024);
  for (const float morph : {0.0F, 0.5F, 0.0F}) {
    const Image expected = picture(*large, sphere_hlod(), 0, morph);
    EXPECT_EQ(picture(*small, sphere_hlod(), 0, morph).pixels, expected.pixels);
    EXPECT_LE(small->mesh_memory().bytes, 32U * 1024U);
  }
  const std::size_t nodes = sphere_hlod().data().levels[0].node_count;
  EXPECT_EQ(large->mesh_memory().nodes, nodes);
  EXPECT_EQ(large->mesh_memory().evictions, 0U);
  EXPECT_EQ(large->mesh_memory().uploads, 2 * nodes);  // once more for where vertices slide to
  EXPECT_LT(small->mesh_memory().nodes, nodes / 4);
  EXPECT_GT(small->mesh_memory().evictions, 2 * nodes);
}

// The longest unused leave: what each frame draws stays.
TEST_P(HlodLifetime, WhatIsDrawnOftenStays) {
  const hlod::Hlod& hlod = sphere_hlod();
  const auto device = make(32 * 1024);
  const hlod::NodeId favourite = hlod.data().levels[0].first_node;
  std::size_t uploads = 0;
  for (hlod::NodeId other = favourite + 1; other < favourite + 60; ++other) {
    begin(*device, hlod);
    draw_node(*device, 0, hlod, favourite);
    draw_node(*device, 0, hlod, other);
    static_cast<void>(device->end_frame());
    ++uploads;
  }
  EXPECT_GT(device->mesh_memory().evictions, 20U);
  EXPECT_EQ(device->mesh_memory().uploads, uploads + 1);
}

TEST_P(HlodLifetime, AMeshLargerThanTheMemoryIsAnError) {
  const auto device = make(2000);
  try {
    begin(*device, sphere_hlod());
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.diagnosis().place, "mesh_bytes");
  }
  // What fits works.
  const hlod::Hlod small = hlod_of(wall());
  EXPECT_EQ(picture(*device, small, 0).pixels, picture(*make(), small, 0).pixels);
}

// Meshes of usual chunks' size and more: each chunk is made for the largest.
TEST_P(HlodLifetime, HlodsOfAnySizeFollowEachOther) {
  hlod::HlodBuildOptions coarse;
  coarse.node_triangles = 4096;
  const hlod::Hlod large = hlod::build_hlod(test::noisy_sphere(5, 1), coarse);
  const auto device = make(1 << 20);
  const Image expected = picture(*make(), large, 0);
  for (int i = 0; i < 2; ++i) {
    static_cast<void>(picture(*device, sphere_hlod(), 0));
    EXPECT_EQ(picture(*device, large, 0).pixels, expected.pixels);
  }
}

// A copy of what is there is not uploaded again, and another HLOD that may lie where one was destroyed is not taken for
// it.
TEST_P(HlodLifetime, HlodsAreKnownByTheirArrays) {
  const auto device = make();
  const auto walls_at = [](float z) {
    Soup soup = wall();
    for (glm::vec3& p : soup.positions) p.z = z;
    return hlod_of(soup);
  };
  auto hlod = std::make_unique<hlod::Hlod>(walls_at(0.0F));
  static_cast<void>(picture(*device, *hlod, 0));
  const hlod::Hlod copy = *hlod;
  static_cast<void>(picture(*device, copy, 0));
  EXPECT_EQ(device->mesh_memory().uploads, 1U);
  for (int i = 0; i < 20; ++i) {
    *hlod = walls_at(-0.1F * static_cast<float>(i));
    static_cast<void>(picture(*device, *hlod, 0));
    EXPECT_EQ(device->read_depth().nearness, [&] {
      const auto fresh = make();
      static_cast<void>(picture(*fresh, *hlod, 0));
      return fresh->read_depth().nearness;
    }()) << i;
    EXPECT_EQ(device->mesh_memory().nodes, 1U);
  }
}

TEST_P(HlodLifetime, ObjectsShareTheMeshesOfTheirHlod) {
  const auto device = make();
  const hlod::Hlod hlod = hlod_of(wall());
  std::vector<hlod::PlacedHlod> objects;
  for (int i = 0; i < 5; ++i) objects.push_back({&hlod, glm::translate(glm::dmat4(1.0), glm::dvec3(0.3 * i, 0, 0))});
  device->begin_frame(view_, objects);
  for (std::uint32_t object = 0; object < 5; ++object) draw_node(*device, object, hlod, 0);
  static_cast<void>(device->end_frame());
  EXPECT_EQ(device->mesh_memory().uploads, 1U);
}

TEST_P(HlodLifetime, TheSizeOfTheViewMayChange) {
  const auto device = make();
  for (const auto& [width, height] : {std::pair(320, 240), {1, 1}, {63, 65}, {1001, 17}, {320, 240}}) {
    Camera camera = sphere_view().camera();
    camera.width = width;
    camera.height = height;
    view_ = View(camera);
    const Image image = picture(*device, sphere_hlod(), 1);
    EXPECT_EQ(image.width, width);
    EXPECT_EQ(image.pixels, picture(*make(), sphere_hlod(), 1).pixels) << width << "x" << height;
  }
}

// Frame after frame by turns, on both platforms, with commands of both under way.
TEST_P(HlodLifetime, ContextsDoNotMix) {
  const Image expected = picture(*make(), sphere_hlod(), 1);
  for (const Platform platform : {Platform::egl, Platform::osmesa}) {
    std::string why;
    const std::shared_ptr<Context> other_context = context_or_null(platform, why);
    if (!other_context) continue;
    const auto one = make();
    const auto other = make_hlod_device(other_context);
    for (int i = 0; i < 2; ++i) {
      begin(*one, sphere_hlod());
      begin(*other, sphere_hlod());
      const std::vector<hlod::BoxRef> box{{0, sphere_hlod().data().box}};
      const hlod::QueryId free = other->ask(box);
      draw_level(*one, sphere_hlod(), 1);
      draw_level(*other, sphere_hlod(), 0);
      const std::vector<hlod::BoxRef> inside{{0, {{-0.1F, -0.1F, -0.1F}, {0.1F, 0.1F, 0.1F}}}};
      EXPECT_EQ(one->wait(one->ask(inside)).front(), 0U);
      EXPECT_GT(other->wait(free).front(), 0U);
      static_cast<void>(one->end_frame());
      static_cast<void>(other->end_frame());
      EXPECT_EQ(one->read_image().pixels, expected.pixels);
    }
  }
}

// A viewer, or another backend, draws in the same context between two frames.
TEST_P(HlodLifetime, OthersMayUseTheContextBetweenFrames) {
  const auto device = make();
  const Image expected = picture(*device, sphere_hlod(), 1);
  const Functions& gl = context_->functions();
  for (const int capability : {GL_BLEND, GL_CULL_FACE, GL_SCISSOR_TEST, GL_STENCIL_TEST, GL_DEPTH_CLAMP,
                               GL_FRAMEBUFFER_SRGB, GL_RASTERIZER_DISCARD, GL_COLOR_LOGIC_OP})
    gl.Enable(static_cast<GLenum>(capability));
  gl.Disable(GL_DEPTH_TEST);
  gl.DepthMask(GL_FALSE);
  gl.DepthFunc(GL_NEVER);
  gl.DepthRange(0.3, 0.4);
  gl.ColorMask(GL_FALSE, GL_TRUE, GL_FALSE, GL_TRUE);
  gl.Viewport(3, 3, 5, 5);
  gl.PixelStorei(GL_PACK_ROW_LENGTH, 7);
  gl.PixelStorei(GL_PACK_ALIGNMENT, 8);
  gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
  gl.UseProgram(0);
  gl.BindVertexArray(0);
  EXPECT_EQ(picture(*device, sphere_hlod(), 1).pixels, expected.pixels);
  const auto query = make_query_occlusion(context_);
  const std::array<ObjectView, 1> objects{ObjectView(view_, glm::dmat4(1.0))};
  query->begin_view(view_, objects);
  EXPECT_EQ(picture(*device, sphere_hlod(), 1).pixels, expected.pixels);
}

TEST_P(HlodLifetime, AHundredFramesLeaveNothing) {
  const auto counting = std::make_shared<CountingContext>(context_);
  auto device = make_hlod_device(counting, {GetParam().quality, 32 * 1024});
  long after_first = 0;
  const std::vector<hlod::BoxRef> box{{0, sphere_hlod().data().box}};
  for (int i = 0; i < 100; ++i) {
    begin(*device, sphere_hlod());
    static_cast<void>(device->ask(box));  // nobody reads it
    static_cast<void>(device->ask_each(box));
    draw_level(*device, sphere_hlod(), 1);
    static_cast<void>(device->wait(device->ask(box)));
    static_cast<void>(device->wait(device->ask_each(box)));
    if (i % 3 != 0) static_cast<void>(device->end_frame());
    if (i == 0) after_first = CountingContext::alive;
  }
  EXPECT_GT(after_first, 0);
  EXPECT_LE(CountingContext::alive, after_first);
  EXPECT_NO_THROW(check(counting->functions(), "a hundred frames"));
  device.reset();
  EXPECT_EQ(CountingContext::alive, 0);
}

TEST_P(HlodLifetime, ErrorsOfOpenGlAreTold) {
  const auto device = make();
  context_->functions().Enable(GL_TRIANGLES);  // not a capability: INVALID_ENUM
  EXPECT_THROW(begin(*device, sphere_hlod()), Error);
  begin(*device, sphere_hlod());
  context_->functions().Enable(GL_TRIANGLES);
  EXPECT_THROW(static_cast<void>(device->end_frame()), Error);
}

TEST_P(HlodLifetime, RefusesWhatMakesNoSense) {
  EXPECT_THROW(static_cast<void>(make_hlod_device(nullptr)), Error);
  EXPECT_THROW(static_cast<void>(make(0)), Error);
  const auto device = make();
  const std::array<hlod::PlacedHlod, 1> flat{{{&sphere_hlod(), glm::scale(glm::dmat4(1.0), glm::dvec3(1, 1, 0))}}};
  EXPECT_THROW(device->begin_frame(view_, flat), Error);
}

// Everything that the device does. The answers and the picture of the last frame.
struct Doings {
  std::vector<std::uint32_t> counts;
  std::vector<glm::u8vec4> pixels;
  friend bool operator==(const Doings&, const Doings&) = default;
};

Doings doings(const std::shared_ptr<Context>& context, bool quality) {
  const auto device = make_hlod_device(context, {quality, std::size_t{1} << 20});
  const hlod::Hlod hlod = hlod_of(wall());
  const std::array<hlod::PlacedHlod, 1> objects{{{&hlod}}};
  const std::vector<hlod::BoxRef> boxes{{0, {{-0.2F, -0.2F, 0.2F}, {0.2F, 0.2F, 0.4F}}},
                                        {0, {{-0.2F, -0.2F, -0.4F}, {0.2F, 0.2F, -0.2F}}}};
  Doings result;
  for (const int width : {64, 80}) {
    Camera camera = test_view().camera();
    camera.width = width;
    device->begin_frame(View(camera), objects);
    draw_node(*device, 0, hlod, 0, width == 64 ? 0.0F : 0.5F);
    const hlod::QueryId batch = device->ask_each(boxes);
    static_cast<void>(device->available(batch));
    for (const std::uint32_t count : device->wait(batch)) result.counts.push_back(count);
    static_cast<void>(device->end_frame());
  }
  result.pixels = device->read_image().pixels;
  return result;
}

// Lost at each call in turn: the one error is told, unless all was done before; it is right then.
TEST_P(HlodLifetime, LostAtAnyCallIsOneError) {
  const bool quality = GetParam().quality;
  const Doings right = doings(context_, quality);
  EXPECT_EQ(doings(std::make_shared<LosingContext>(context_, std::numeric_limits<long>::max()), quality), right);
  const long calls = LosingContext::calls;
  long losses = 0;
  for (long n = 0; n < calls; ++n) {
    SCOPED_TRACE("lost after call " + std::to_string(n));
    std::string why;
    const auto losing = std::make_shared<LosingContext>(context_or_null(GetParam().platform, why), n);
    try {
      ASSERT_EQ(doings(losing, quality), right);
    } catch (const Error& error) {
      ASSERT_EQ(error.diagnosis().subject, "OpenGL");
      ASSERT_NE(std::string(error.what()).find("another program has made the GPU reset"), std::string::npos)
          << error.what();
      ++losses;
    }
  }
  EXPECT_GT(losses, calls / 2);
  EXPECT_EQ(doings(context_, quality), right);
}

TEST_P(HlodLifetime, StaysLost) {
  const auto whole = std::make_shared<LosingContext>(context_, std::numeric_limits<long>::max());
  const auto device = make_hlod_device(whole, {GetParam().quality});
  begin(*device, sphere_hlod());
  const hlod::QueryId query = device->ask(std::vector<hlod::BoxRef>{{0, sphere_hlod().data().box}});
  const auto lost = std::make_shared<LosingContext>(context_, 0);  // `whole` too: their tables share the calls
  EXPECT_THROW(static_cast<void>(device->wait(query)), ContextLost);
  EXPECT_THROW(static_cast<void>(device->end_frame()), ContextLost);
  for (int i = 0; i < 2; ++i) EXPECT_THROW(begin(*device, sphere_hlod()), ContextLost);
  EXPECT_THROW(static_cast<void>(make_hlod_device(lost)), ContextLost);
}

TEST_P(HlodLifetime, LostWhileWaitingIsNotASilentDriver) {
  const auto device = make_hlod_device(std::make_shared<HangingContext>(context_), {GetParam().quality});
  begin(*device, sphere_hlod());
  const std::vector<hlod::BoxRef> box{{0, sphere_hlod().data().box}};
  const hlod::QueryId query = device->ask(box), batch = device->ask_each(box);
  EXPECT_THROW(static_cast<void>(device->wait(query)), ContextLost);
  EXPECT_THROW(static_cast<void>(device->wait(batch)), ContextLost);
}

// Random ranges of a hundred units against a table of which units are taken.
TEST(RangeAllocator, RangesNeverOverlapAndGapsJoin) {
  RangeAllocator ranges(100);
  std::vector<bool> taken(100, false);
  std::vector<std::pair<std::size_t, std::size_t>> given;
  std::mt19937 random(1);
  std::size_t refused = 0;
  for (int i = 0; i < 20'000; ++i) {
    if (random() % 2 == 0) {
      const std::size_t count = 1 + random() % 20;
      std::size_t run = 0;
      std::size_t longest = 0;
      for (const bool used : taken) longest = std::max(longest, run = used ? 0 : run + 1);
      const auto first = ranges.take(count);
      ASSERT_EQ(first.has_value(), longest >= count);
      if (!first) {
        ++refused;
        continue;
      }
      for (std::size_t k = *first; k < *first + count; ++k) {
        ASSERT_FALSE(taken[k]);
        taken[k] = true;
      }
      given.emplace_back(*first, count);
    } else if (!given.empty()) {
      std::swap(given[random() % given.size()], given.back());
      const auto [first, count] = given.back();
      given.pop_back();
      ranges.give_back(first, count);
      for (std::size_t k = first; k < first + count; ++k) taken[k] = false;
    }
  }
  EXPECT_GT(refused, 100U);
  for (const auto& [first, count] : given) ranges.give_back(first, count);
  EXPECT_EQ(ranges.take(100), 0U);
}

}  // namespace
}  // namespace occlod::gl
