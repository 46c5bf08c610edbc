#include <algorithm>
#include <array>
#include <cstring>
#include <glm/ext/matrix_transform.hpp>
#include <string>
#include <vector>

#include "base/timing.h"
#include "hlod/store/hlod_data.h"
#include "occlod/device.h"

namespace occlod::hlod {
namespace {

constexpr int rounds = 9;
constexpr std::size_t latencies = 1000;
constexpr double min_ns = 1e-3;
constexpr int image_side = 512;
constexpr double ns = 1e6;  // per ms

// Returns an HLOD of one node: the square [-1, 1]^2 in the plane z = 0, divided into cells of two triangles.
Hlod one_node(std::uint16_t cells) {
  const std::uint16_t side = cells + 1;
  std::vector<glm::vec3> positions;
  std::vector<std::uint16_t> indices;
  for (std::uint16_t y = 0; y < side; ++y)
    for (std::uint16_t x = 0; x < side; ++x)
      positions.emplace_back(2.0F * x / cells - 1.0F, 2.0F * y / cells - 1.0F, 0.0F);
  for (std::uint16_t y = 0; y < cells; ++y)
    for (std::uint16_t x = 0; x < cells; ++x) {
      const auto a = static_cast<std::uint16_t>(y * side + x), b = static_cast<std::uint16_t>(a + side);
      for (const int i : {a + 0, a + 1, b + 1, a + 0, b + 1, b + 0}) indices.push_back(static_cast<std::uint16_t>(i));
    }
  HlodData data;
  Node node;
  node.box = node.lod_box = data.box = {{-1.0F, -1.0F, 0.0F}, {1.0F, 1.0F, 0.0F}};
  node.sphere = {{0.0F, 0.0F, 0.0F}, 1.5F};
  node.area = 4.0F;
  node.triangles = static_cast<std::uint32_t>(indices.size() / 3);
  node.vertices = static_cast<std::uint32_t>(positions.size());
  node.patches = 1;
  const MeshLayout layout(node, {});
  data.meshes.assign((layout.bytes + mesh_alignment - 1) / mesh_alignment * mesh_alignment, std::byte{0});
  std::memcpy(data.meshes.data(), positions.data(), positions.size() * sizeof(glm::vec3));
  std::memcpy(data.meshes.data() + layout.indices, indices.data(), indices.size() * sizeof(std::uint16_t));
  std::memset(data.meshes.data() + layout.merged_into, 0xff,
              positions.size() * sizeof(std::uint16_t));  // stays
  data.nodes = {node};
  data.patches = {{no_id, 0, static_cast<std::uint32_t>(indices.size())}};
  data.roots = {0};
  data.levels = {{0, 1}};
  data.input_triangle_count = node.triangles;
  data.node_triangles = node.triangles;
  return make_hlod(std::move(data));
}

// Draws and queries the paper's objects O+ and O-, large and small.
class Workload {
 public:
  explicit Workload(RenderDevice& device) : device_(device) {}

  [[nodiscard]] DeviceCosts measure();

 private:
  enum Object : std::uint32_t { many_small, few_small, few_large };
  struct Counts {
    std::size_t few, many;
  };

  void draw(Object object, std::size_t times) {
    const DrawRange all{0, objects_[object].hlod->node(0).triangles * 3};
    for (std::size_t i = 0; i < times; ++i) device_.draw({object, 0, {&all, 1}});
  }
  // Returns a box slightly thicker than the square, which stays behind the near plane.
  [[nodiscard]] static BoxRef box(Object object) { return {object, {{-1.0F, -1.0F, -0.01F}, {1.0F, 1.0F, 0.01F}}}; }
  void ask(Object object, std::size_t times) {
    const BoxRef asked = box(object);
    for (std::size_t i = 0; i < times; ++i) static_cast<void>(device_.ask({&asked, 1}));
  }
  void ask_batches(std::size_t boxes, std::size_t times) {
    const std::vector<BoxRef> asked(boxes, box(few_small));
    for (std::size_t i = 0; i < times; ++i) static_cast<void>(device_.ask_each(asked));
  }

  template <typename Work>
  FrameTimes frame(const Work& work) {
    device_.begin_frame(view_, objects_);
    work();
    return device_.end_frame();
  }
  // Returns the time, of the kind `of`, that one more repetition takes; work(count) repeats the work.
  template <typename Work>
  double one_more_ns(const Counts& counts, double FrameTimes::*of, const Work& work) {
    std::vector<double> found;
    for (int i = 0; i < rounds; ++i) {
      const double few = frame([&] { work(counts.few); }).*of, many = frame([&] { work(counts.many); }).*of;
      found.push_back(ns * (many - few) / static_cast<double>(counts.many - counts.few));
    }
    return std::max(median(std::move(found)), min_ns);
  }
  [[nodiscard]] double latency_ns();

  RenderDevice& device_;
  Hlod many_ = one_node(180), few_ = one_node(1);
  View view_{[] {
    Camera camera;
    camera.eye = {0.0, 0.0, 2.0};
    camera.target = {0.0, 0.0, 0.0};
    camera.width = camera.height = image_side;
    camera.near = 0.1;
    camera.far = 10.0;
    return camera;
  }()};
  // There a pixel is at least 2 * 2 tan(fov / 2) / 512 wide; the large object reaches beyond the edges.
  std::array<PlacedHlod, 3> objects_{{{&many_, glm::scale(glm::dmat4(1.0), glm::dvec3(1e-4))},
                                      {&few_, glm::scale(glm::dmat4(1.0), glm::dvec3(1e-4))},
                                      {&few_, glm::scale(glm::dmat4(1.0), glm::dvec3(4.0))}}};
};

double Workload::latency_ns() {
  std::vector<double> empty, asked;
  const BoxRef small = box(few_small);
  for (std::size_t i = 0; i < latencies; ++i) {
    if (i % 10 == 0) empty.push_back(frame([] {}).frame_ms);
    asked.push_back(frame([&] { static_cast<void>(device_.wait(device_.ask({&small, 1}))); }).frame_ms);
  }
  std::sort(asked.begin(), asked.end());
  return ns * (asked[latencies - latencies / 1000 - 1] - median(std::move(empty)));
}

DeviceCosts Workload::measure() {
  constexpr double pixels = static_cast<double>(image_side) * image_side;
  constexpr std::size_t batch = 64;
  constexpr Counts commands{64, 256}, fills{2, 8};
  const auto frame_ms = &FrameTimes::frame_ms, cpu_ms = &FrameTimes::cpu_ms;
  for (const Object object : {many_small, few_small, few_large}) frame([&] { draw(object, 1), ask(object, 1); });

  DeviceCosts costs;
  costs.name = device_.name();
  const auto small_draws = [&](std::size_t times) { draw(few_small, times); };
  costs.draw_ns = one_more_ns(commands, frame_ms, small_draws);
  costs.triangle_ns =
      one_more_ns(fills, frame_ms, [&](std::size_t times) { draw(many_small, times); }) / many_.node(0).triangles;
  costs.fragment_ns = one_more_ns(fills, frame_ms, [&](std::size_t times) { draw(few_large, times); }) / pixels;
  costs.query_ns = one_more_ns(commands, frame_ms, [&](std::size_t times) { ask(few_small, times); });
  costs.query_fragment_ns = one_more_ns(fills, frame_ms, [&](std::size_t times) { ask(few_large, times); }) / pixels;
  const double both_ns = one_more_ns(commands, frame_ms, [&](std::size_t times) {
    for (std::size_t i = 0; i < times; ++i) ask(few_small, 1), draw(few_small, 1);
  });
  costs.wrapped_query_ns = std::max(both_ns - costs.draw_ns, min_ns);
  costs.batch_item_ns = one_more_ns(commands, frame_ms, [&](std::size_t boxes) { ask_batches(boxes, 1); });
  const double batch_ns = one_more_ns({1, 4}, frame_ms, [&](std::size_t times) { ask_batches(batch, times); });
  costs.batch_ns = std::max(batch_ns - batch * costs.batch_item_ns, min_ns);
  costs.submit_ns = one_more_ns(commands, cpu_ms, small_draws);
  costs.visit_ns = one_more_ns(commands, cpu_ms, [&](std::size_t times) { device_.visit(times); });
  costs.readback_ns = std::max(latency_ns() - costs.query_ns - costs.submit_ns, min_ns);
  return costs;
}

}  // namespace

DeviceCosts measure_costs(RenderDevice& device) { return Workload(device).measure(); }

}  // namespace occlod::hlod
