// Many nodes by one call of OpenGL: the same image, the same answers, the same fronts as node by node.
#include <array>
#include <glm/ext/matrix_transform.hpp>

#include "gl/backend_options.h"
#include "gl/counting_context.h"
#include "gl/hlod_cases.h"
#include "occlod/build_hlod.h"
#include "occlod/generate.h"
#include "papers/trial_traverser.h"
#include "support/scripted_device.h"

namespace occlod::gl {
namespace {

// A driver that is not known to draw on the processor.
class GpuContext : public ContextWithFunctions {
 public:
  explicit GpuContext(const std::shared_ptr<Context>& inner) : ContextWithFunctions(inner) {}
  [[nodiscard]] std::string renderer() const final { return "a GPU"; }
};

// OpenGL 3.3 without extensions.
class OldContext final : public ContextWithFunctions {
 public:
  explicit OldContext(const std::shared_ptr<Context>& inner) : ContextWithFunctions(inner) {
    functions_.version = 33;
    functions_.MultiDrawElementsIndirect = nullptr;
  }
};

Box small_cube(const glm::vec3& middle) { return {middle - 0.02F, middle + 0.02F}; }

// What one frame shows and answers.
struct Seen {
  std::vector<float> depth;
  std::vector<glm::u8vec4> pixels;
  std::vector<std::uint32_t> counts;
  friend bool operator==(const Seen&, const Seen&) = default;
};

class HlodCalls : public EachHlodDevice {
 protected:
  void SetUp() override {
    EachHlodDevice::SetUp();
    view_ = sphere_view();
    if (!IsSkipped() && context_->functions().MultiDrawElementsIndirect == nullptr)
      GTEST_SKIP() << "no indirect draws: " << context_->version();
  }
  [[nodiscard]] std::unique_ptr<HlodDevice> make_from(std::shared_ptr<Context> context, bool indirect,
                                                      std::size_t mesh_bytes = HlodDeviceOptions{}.mesh_bytes) const {
    return make_hlod_device(std::move(context), {GetParam().quality, mesh_bytes}, {.indirect = indirect});
  }
  // Two spheres side by side, the left one morphing patch by patch, with gaps in some nodes; boxes are asked about near
  // the end.
  [[nodiscard]] Seen scene(HlodDevice& device) const {
    const hlod::Hlod& hlod = sphere_hlod();
    const std::array<hlod::PlacedHlod, 2> objects{
        {{&hlod, glm::translate(glm::dmat4(1.0), glm::dvec3(-0.6, 0, 0))},
         {&hlod, glm::translate(glm::dmat4(1.0), glm::dvec3(0.6, 0.1, -0.2))}}};
    device.begin_frame(view_, objects);
    Seen seen;
    const hlod::Level& level = hlod.data().levels[0];
    std::vector<hlod::DrawRange> ranges;
    for (hlod::NodeId n = level.first_node; n < level.first_node + level.node_count; ++n) {
      ranges.clear();
      for (std::size_t p = 0; p < hlod.patches(n).size(); ++p)
        if (const hlod::Patch& patch = hlod.patches(n)[p]; n % 4 != 0 || p != 1)
          ranges.push_back({patch.first_index, patch.index_count, 0.25F * static_cast<float>((n + p) % 4)});
      device.draw({0, n, ranges});
      if (n % 3 != 0) draw_node(device, 1, hlod, n);
      if (n != level.first_node + level.node_count * 3 / 4) continue;
      std::vector<hlod::BoxRef> boxes;
      for (hlod::NodeId asked = level.first_node; asked < level.first_node + level.node_count; ++asked)
        boxes.push_back({asked % 2, small_cube(hlod.mesh(asked).positions.front())});
      const auto counts = device.wait(device.ask_each(boxes));
      seen.counts.assign(counts.begin(), counts.end());
    }
    static_cast<void>(device.end_frame());
    seen.depth = device.read_depth().nearness;
    seen.pixels = device.read_image().pixels;
    return seen;
  }
};
INSTANTIATE_TEST_SUITE_P(Gl, HlodCalls, testing::ValuesIn(tested_devices()), device_label);

// Also where meshes leave while draws of them are gathered.
TEST_P(HlodCalls, ShowAndAnswerTheSameAsNodeByNode) {
  const Seen expected = scene(*make_from(context_, false));
  EXPECT_GT(std::count(expected.counts.begin(), expected.counts.end(), 0U), 5);
  EXPECT_LT(std::count(expected.counts.begin(), expected.counts.end(), 0U), std::ssize(expected.counts) - 5);
  for (const auto& context : {context_, std::shared_ptr<Context>(std::make_shared<GpuContext>(context_))})
    for (const std::size_t mesh_bytes : {std::size_t{32} << 10U, HlodDeviceOptions{}.mesh_bytes}) {
      SCOPED_TRACE(context->renderer() + " " + std::to_string(mesh_bytes));
      const auto device = make_from(context, true, mesh_bytes);
      EXPECT_EQ(scene(*device), expected);
      EXPECT_EQ(device->mesh_memory().evictions > 0, mesh_bytes < HlodDeviceOptions{}.mesh_bytes);
      EXPECT_EQ(scene(*device), expected);  // nothing is left over
    }
}

// A mesh whose range another one takes, in a frame where nothing else makes the draws be given to OpenGL.
TEST_P(HlodCalls, MeshesAreDrawnBeforeTheyLeave) {
  const auto depth = [&](HlodDevice& device) {
    const std::array<hlod::PlacedHlod, 1> objects{{{&sphere_hlod()}}};
    device.begin_frame(view_, objects);
    draw_level(device, sphere_hlod(), 1);
    static_cast<void>(device.end_frame());
    return device.read_depth().nearness;
  };
  const auto device = make_from(std::make_shared<GpuContext>(context_), true, 32 << 10);
  EXPECT_EQ(depth(*device), depth(*make_from(context_, false)));
  EXPECT_GT(device->mesh_memory().evictions, 0U);
}

// One call for each object, whatever the order; on the processor for each eight draws.
TEST_P(HlodCalls, AreFewerThanNodes) {
  const hlod::Hlod& hlod = sphere_hlod();
  const hlod::Level& level = hlod.data().levels[0];
  const std::array<hlod::PlacedHlod, 2> objects{{{&hlod}, {&hlod}}};
  const auto calls = [&](HlodDevice& device) {
    device.begin_frame(view_, objects);
    for (hlod::NodeId n = level.first_node; n < level.first_node + level.node_count; ++n)
      for (const std::uint32_t object : {0U, 1U}) draw_node(device, object, hlod, n);
    static_cast<void>(device.end_frame());
    EXPECT_EQ(device.calls().draws, 2 * level.node_count);
    return device.calls().draw_calls;
  };
  ASSERT_GT(level.node_count, 100U);
  EXPECT_EQ(calls(*make_from(std::make_shared<GpuContext>(context_), true)), 2U);
  EXPECT_EQ(calls(*make_from(context_, false)), 2 * level.node_count);
  EXPECT_EQ(calls(*make_from(std::make_shared<OldContext>(context_), true)), 2 * level.node_count);
  if (context_->renderer().find("llvmpipe") != std::string::npos) {
    EXPECT_EQ(calls(*make_from(context_, true)), 2 * ((2 * level.node_count + 7) / 8));
  }
}

// A question gives OpenGL what is drawn before it, and so does a picture in the middle of a frame.
TEST_P(HlodCalls, QuestionsAndPicturesSeeAllDrawsBefore) {
  const hlod::Hlod walls = hlod_of(wall());
  const auto device = make_from(std::make_shared<GpuContext>(context_), true);
  const std::array<hlod::PlacedHlod, 1> objects{{{&walls}}};
  const hlod::BoxRef behind{0, {{-0.2F, -0.2F, -0.7F}, {0.2F, 0.2F, -0.3F}}};
  device->begin_frame(test_view(), objects);
  draw_node(*device, 0, walls, 0);  // so that the mesh is there, and nothing but the draw makes a difference
  static_cast<void>(device->end_frame());
  device->begin_frame(test_view(), objects);
  const hlod::QueryId before = device->ask({&behind, 1});
  draw_node(*device, 0, walls, 0);
  const hlod::QueryId after = device->ask({&behind, 1});
  EXPECT_GT(device->wait(before).front(), 0U);
  EXPECT_EQ(device->wait(after).front(), 0U);
  EXPECT_EQ(device->calls().draw_calls, 1U);
  device->begin_frame(test_view(), objects);
  draw_node(*device, 0, walls, 0);
  EXPECT_EQ(device->calls().draw_calls, 0U);
  EXPECT_GT(device->read_depth().nearness[24 * 64 + 32], 0.0F);
  EXPECT_EQ(device->calls().draw_calls, 1U);
  // What was gathered in a frame that was not ended is not drawn in the next.
  device->begin_frame(test_view(), objects);
  draw_node(*device, 0, walls, 0);
  device->begin_frame(test_view(), objects);
  EXPECT_EQ(device->read_depth().nearness[24 * 64 + 32], 0.0F);
}

// Along a walk around the sphere, with strategies that draw and ask by turns.
TEST_P(HlodCalls, TheFrontsAreTheSame) {
  const hlod::PlacedHlod placed{&sphere_hlod()};
  const std::shared_ptr<Context> context = std::make_shared<GpuContext>(context_);
  const auto many = make_from(context, true), one = make_from(context, false);
  occlod::test::PromptDevice prompt_many(*many), prompt_one(*one);
  std::size_t hidden = 0;
  for (const hlod::TrialStrategy strategy :
       {hlod::TrialStrategy::sw_b, hlod::TrialStrategy::coh, hlod::TrialStrategy::nohc, hlod::TrialStrategy::batch,
        hlod::TrialStrategy::two_pass}) {
    hlod::TrialTraverser traverser({&placed, 1}), expected({&placed, 1});
    hlod::TrialOptions options;
    options.strategy = strategy;
    options.costs = {.draw_ns = 2000, .triangle_ns = 5, .fragment_ns = 0.2, .query_ns = 100};
    for (int i = 0; i < 4; ++i) {
      Camera camera = view_.camera();
      camera.eye = {2.5 * std::sin(0.3 * i), 0.5, 2.5 * std::cos(0.3 * i)};
      const View view(camera);
      const std::uint64_t front = traverser.draw_frame(view, prompt_many, options).front_hash;
      const hlod::Frame& wanted = expected.draw_frame(view, prompt_one, options);
      ASSERT_EQ(front, wanted.front_hash) << static_cast<int>(strategy) << " frame " << i;
      ASSERT_EQ(many->read_depth().nearness, one->read_depth().nearness)
          << static_cast<int>(strategy) << " frame " << i;
      EXPECT_LE(many->calls().draw_calls, one->calls().draw_calls);
      hidden += wanted.stats.hidden_nodes;
    }
  }
  EXPECT_GT(hidden, 50U);
}

}  // namespace
}  // namespace occlod::gl
