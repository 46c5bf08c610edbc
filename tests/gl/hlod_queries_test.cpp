// What the device `gl` counts, beyond what tests/device asks of every device.
#include <array>

#include "gl/backend_options.h"
#include "gl/counting_context.h"
#include "gl/hlod_cases.h"
#include "occlod/base.h"

namespace occlod::gl {
namespace {

constexpr std::uint32_t all_pixels = 64 * 48;  // of test_view()

Box cube(const glm::vec3& center, float half) { return {center - half, center + half}; }

class HlodQueries : public EachHlodDevice {
 protected:
  void SetUp() override {
    EachHlodDevice::SetUp();
    if (!IsSkipped()) device_ = make();
  }
  void begin(const glm::dmat4& object_to_world = glm::dmat4(1.0)) {
    const std::array<hlod::PlacedHlod, 1> objects{{{&wall_, object_to_world, false}}};
    device_->begin_frame(view_, objects);
  }
  void draw_wall() { draw_node(*device_, 0, wall_, 0); }
  [[nodiscard]] std::uint32_t count(const Box& box) { return count(std::vector<hlod::BoxRef>{{0, box}}); }
  [[nodiscard]] std::uint32_t count(const std::vector<hlod::BoxRef>& boxes) {
    return device_->wait(device_->ask(boxes)).front();
  }

  const hlod::Hlod wall_ = hlod_of(wall());
  std::unique_ptr<HlodDevice> device_;
};
INSTANTIATE_TEST_SUITE_P(Gl, HlodQueries, testing::ValuesIn(tested_devices()), device_label);

// The front of the cube is 0.4 units wide at distance 2.5: 0.4 / (pixel_at_wall * 2.5 / 3) = 9.27 pixels, and 3/4 pixel
// more at the distance of its back, 2.9, all around: 10.6 to 11.1 in all. In front of the wall everything counts,
// behind it nothing.
// Upper and lower half beyond the wall's right border at x = 1: about half of the box is seen.
// Each query counts against the draws before it, and none after it.
// What is asked neither hides nor colours anything.
TEST_P(HlodQueries, BoxesLeaveNoTrace) {
  begin();
  const std::uint32_t first = count(cube({0, 0, 0.5F}, 0.2F));
  EXPECT_EQ(count(cube({0, 0, 0.5F}, 0.2F)), first);
  EXPECT_GT(count(cube({0, 0, -0.5F}, 0.2F)), 50U);
  static_cast<void>(device_->end_frame());
  const std::vector<float> nothing(all_pixels, 0.0F);
  EXPECT_EQ(device_->read_depth().nearness, nothing);
  const Image image = device_->read_image();
  EXPECT_EQ(image.pixels[24 * 64 + 32], image.pixels[24 * 64]);
}

TEST_P(HlodQueries, DrawsAndQueriesMayAlternate) {
  begin();
  for (int i = 0; i < 3; ++i) {
    draw_wall();
    EXPECT_EQ(count(cube({0, 0, -0.5F}, 0.2F)), 0U);
    EXPECT_GT(count(cube({0, 0, 0.5F}, 0.2F)), 50U);
  }
  static_cast<void>(device_->end_frame());
  const Image image = device_->read_image();
  EXPECT_NE(image.pixels[24 * 64 + 32], image.pixels[24 * 64]);  // it is drawn in colour
}

// Each answer has a place of its own until something new is asked.
TEST_P(HlodQueries, AnswersLiveOnWhileOthersAreWaitedFor) {
  begin();
  draw_wall();
  const std::vector<hlod::BoxRef> boxes{{0, cube({-0.5F, 0, 0.3F}, 0.1F)}, {0, cube({0, 0, -0.5F}, 0.1F)}};
  const hlod::QueryId batch = device_->ask_each(boxes);
  const hlod::QueryId single = device_->ask(std::span(boxes).first(1));
  const std::span<const std::uint32_t> counts = device_->wait(batch);
  EXPECT_GT(counts[0], 10U);
  EXPECT_EQ(device_->wait(single).front(), counts[0]);
  EXPECT_EQ(device_->wait(batch).data(), counts.data());
  EXPECT_EQ(counts[1], 0U);
}

TEST_P(HlodQueries, TimesAddUp) {
  begin();
  draw_wall();
  static_cast<void>(count(cube({0, 0, 0.5F}, 0.2F)));
  device_->visit(3);
  const hlod::FrameTimes times = device_->end_frame();
  EXPECT_GT(times.stall_ms, 0.0);
  EXPECT_GE(times.cpu_ms, times.stall_ms);
  EXPECT_GE(times.frame_ms, times.cpu_ms);
  if (context_->renderer().find("llvmpipe") != std::string::npos) {
    EXPECT_FALSE(device_->measures_gpu());
  }
  if (device_->measures_gpu()) {
    EXPECT_GT(times.gpu_ms, 0.0);
    EXPECT_LE(times.gpu_ms + times.starve_ms, times.frame_ms);
  } else {
    EXPECT_EQ(times.gpu_ms, 0.0);
    EXPECT_EQ(times.starve_ms, 0.0);
  }
}

// Counts too much, as llvmpipe has been seen to.
class BoastingContext final : public ContextWithFunctions {
 public:
  explicit BoastingContext(const std::shared_ptr<Context>& inner) : ContextWithFunctions(inner) {
    real = &inner->functions();
    functions_.GetQueryObjectuiv = [](GLuint query, GLenum name, GLuint* value) {
      real->GetQueryObjectuiv(query, name, value);
      if (name == GL_QUERY_RESULT) *value += 4 * 63'000;
    };
    functions_.GetBufferSubData = [](GLenum target, GLintptr offset, GLsizeiptr bytes, void* data) {
      real->GetBufferSubData(target, offset, bytes, data);
      for (GLsizeiptr i = 0; i < bytes / 4; ++i) static_cast<std::uint32_t*>(data)[i] += 63'000;
    };
  }

 private:
  static inline const Functions* real = nullptr;
};

TEST_P(HlodQueries, CountsAreBelievedOnlyAsFarAsTheBoxReaches) {
  device_ = make_hlod_device(std::make_shared<BoastingContext>(context_), {GetParam().quality});
  begin();
  const std::uint32_t small = count({{-0.2F, -0.2F, 0.1F}, {0.2F, 0.2F, 0.5F}});
  EXPECT_GE(small, 9U * 9U);
  EXPECT_LE(small, 13U * 13U);
  const std::vector<hlod::BoxRef> each{{0, {{-0.2F, -0.2F, 0.1F}, {0.2F, 0.2F, 0.5F}}}, {0, cube({50, 0, 0}, 0.1F)}};
  const auto counts = device_->wait(device_->ask_each(each));
  EXPECT_EQ(counts[0], small);
  EXPECT_EQ(counts[1], 0U);  // beside the image
  const std::vector<hlod::BoxRef> many(100, {0, {{-0.5F, -0.5F, 0.1F}, {0.5F, 0.5F, 0.5F}}});
  EXPECT_EQ(count(many), all_pixels);
}

// A batch is one call, and its counts are those of a query for each box: also of several batches that are under way at
// once, behind draws that come in between, and of boxes that are not drawn.
TEST_P(HlodQueries, BatchesAreOneCall) {
  const bool marks = !GetParam().quality && context_->functions().version >= 43;
  const auto plain = make_hlod_device(context_, {.quality = GetParam().quality}, {.marks = false});
  std::vector<hlod::BoxRef> boxes;
  for (int i = 0; i < 40; ++i)
    boxes.push_back(
        {0, cube({0.05F * static_cast<float>(i) - 1.0F, 0.01F * static_cast<float>(i), i % 2 == 0 ? -0.4F : 0.4F},
                 0.02F * static_cast<float>(1 + i % 7))});
  boxes.push_back({0, cube({0, 0, 3}, 0.2F)});   // through the near plane
  boxes.push_back({0, cube({50, 0, 0}, 0.1F)});  // beside the image
  const std::size_t drawn = boxes.size() - 2;
  std::vector<std::vector<std::uint32_t>> found;
  for (HlodDevice* const device : {device_.get(), plain.get()}) {
    const std::array<hlod::PlacedHlod, 1> objects{{{&wall_}}};
    device->begin_frame(view_, objects);
    const hlod::QueryId before = device->ask_each(boxes);
    draw_node(*device, 0, wall_, 0);
    const hlod::QueryId behind = device->ask_each(boxes), single = device->ask(std::span(boxes).subspan(3, 1));
    const hlod::QueryId again = device->ask_each(std::span(boxes).first(5));
    std::vector<std::uint32_t>& counts = found.emplace_back();
    for (const hlod::QueryId query : {again, single, behind, before}) {
      const auto answer = device->wait(query);
      EXPECT_TRUE(device->available(query));
      counts.insert(counts.end(), answer.begin(), answer.end());
    }
    EXPECT_EQ(device->calls().boxes, 2 * drawn + 6);
    EXPECT_EQ(device->calls().box_calls, device == device_.get() && marks ? 4U : 2 * drawn + 6);
    static_cast<void>(device->ask_each(boxes));  // nobody reads it
    static_cast<void>(device->end_frame());
  }
  EXPECT_EQ(found[0], found[1]);
  const auto hidden = std::count(found[0].begin() + 6, found[0].begin() + 6 + std::ssize(boxes), 0U);
  EXPECT_GT(hidden, 10);
  EXPECT_LT(hidden, 30);
}

// Never says that an answer is there.
class SilentContext final : public ContextWithFunctions {
 public:
  explicit SilentContext(const std::shared_ptr<Context>& inner) : ContextWithFunctions(inner) {
    functions_.GetQueryObjectuiv = [](GLuint, GLenum, GLuint* value) { *value = GL_FALSE; };
    functions_.ClientWaitSync = [](GLsync, GLbitfield, GLuint64) -> GLenum { return GL_TIMEOUT_EXPIRED; };
  }
};

TEST(SilentDriver, IsAnErrorAfterTenSeconds) {
  std::string why;
  const std::shared_ptr<Context> context = context_or_null(Platform::egl, why);
  if (!context) GTEST_SKIP() << "no context: " << why;
  const auto device = make_hlod_device(std::make_shared<SilentContext>(context));
  const hlod::Hlod hlod = hlod_of(wall());
  const std::array<hlod::PlacedHlod, 1> objects{{{&hlod}}};
  device->begin_frame(test_view(), objects);
  const hlod::QueryId query = device->ask(std::vector<hlod::BoxRef>{{0, cube({0, 0, 0.5F}, 0.2F)}});
  EXPECT_FALSE(device->available(query));
  EXPECT_THROW(static_cast<void>(device->wait(query)), Error);
  const hlod::QueryId batch = device->ask_each(std::vector<hlod::BoxRef>{{0, cube({0, 0, 0.5F}, 0.2F)}});
  EXPECT_FALSE(device->available(batch));
  EXPECT_THROW(static_cast<void>(device->end_frame()), Error);
}

}  // namespace
}  // namespace occlod::gl
