// bench_hlod_device: what drawing a node and counting the pixels of a box cost the devices `software`, `virtual` and
// `recorded`. The label of a row is the hash of what was drawn or counted, the same on every machine.
#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <xxhash.h>

#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "occlod/build_hlod.h"
#include "occlod/generate.h"
#include "papers/trial_devices.h"
#include "support/bench_meshes.h"
#include "support/run_benchmarks.h"

namespace occlod::bench {
namespace {

using hlod::BoxRef;
using hlod::Hlod;
using hlod::NodeId;

struct Scene {
  const char* name;
  Hlod hlod;
  Camera camera;
};

// A planet that fills the height of 1024 x 768 pixels, and a city from the street: many small nodes that all show their
// front, and a few large ones before many hidden.
const std::vector<Scene>& scenes() {
  static const std::vector<Scene> all = [] {
    std::vector<Scene> result;
    result.push_back({"planet", hlod::build_hlod(load_bench_mesh("planet:8")), {.near = 0.1, .far = 10.0}});
    Hlod city = hlod::build_hlod(generate("city", {{"blocks", 16}, {"facade_cells", 8}}));
    const glm::dvec3 min(city.data().box.min), size = glm::dvec3(city.data().box.max) - min;
    const glm::dvec3 eye(min.x + 0.5 * size.x, min.y + 0.02 * size.y, min.z + 0.1 * size.z);
    Camera street{.eye = eye, .target = eye + glm::dvec3(0.1, 1.0, 0.0), .up = {0.0, 0.0, 1.0}};
    street.near = 1e-3 * size.y;
    street.far = 2.0 * size.y;
    result.push_back({"city", std::move(city), street});
    return result;
  }();
  return all;
}

std::vector<BoxRef> boxes_of(const Hlod& hlod) {
  std::vector<BoxRef> boxes;
  for (const hlod::Node& node : hlod.data().nodes) boxes.push_back({0, node.box});
  return boxes;
}

void begin(hlod::RenderDevice& device, const Scene& scene) {
  const hlod::PlacedHlod placed{&scene.hlod};
  device.begin_frame(View(scene.camera), {&placed, 1});
}

void draw_level(hlod::RenderDevice& device, const Hlod& hlod, std::size_t level, float morph) {
  const hlod::Level& nodes = hlod.data().levels[level];
  for (NodeId n = nodes.first_node; n < nodes.first_node + nodes.node_count; ++n) {
    const hlod::DrawRange range{0, 3 * hlod.node(n).triangles, morph};
    if (range.index_count > 0) device.draw({0, n, {&range, 1}});
  }
}

std::string hash_of(const DepthBuffer& depth) {
  return fmt::format("{:016x}", XXH3_64bits(depth.nearness.data(), depth.nearness.size() * sizeof(float)));
}

// Draws a level of the scene on an empty image.
void draw(benchmark::State& state, const Scene& scene, std::size_t level, float morph, bool items) {
  hlod::SoftwareDevice device(items);
  for ([[maybe_unused]] auto iteration : state) {
    begin(device, scene);
    draw_level(device, scene.hlod, level, morph);
  }
  state.SetLabel(hash_of(device.depth()));
  const auto rate = [](std::uint64_t count) {
    return benchmark::Counter(static_cast<double>(count),
                              benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  };
  state.counters["s/node"] = rate(device.work().draws);
  state.counters["s/triangle"] = rate(device.work().triangles);
  state.counters["fragments/triangle"] =
      static_cast<double>(device.work().fragments) / static_cast<double>(device.work().triangles);
}

// Asks about all nodes, on an empty image or behind all that level 0 shows.
void ask(benchmark::State& state, const Scene& scene, hlod::RenderDevice& device, bool drawn, bool each) {
  const std::vector<BoxRef> boxes = boxes_of(scene.hlod);
  std::vector<std::uint32_t> counts;
  for ([[maybe_unused]] auto iteration : state) {
    state.PauseTiming();
    begin(device, scene);
    if (drawn) draw_level(device, scene.hlod, 0, 0.0F);
    counts.clear();
    state.ResumeTiming();
    if (each) {
      const auto found = device.wait(device.ask_each(boxes));
      counts.assign(found.begin(), found.end());
    } else {
      for (const BoxRef& box : boxes) counts.push_back(device.wait(device.ask({&box, 1}))[0]);
    }
  }
  device.end_frame();
  state.SetLabel(fmt::format("{:016x}", XXH3_64bits(counts.data(), counts.size() * sizeof(std::uint32_t))));
  state.counters["s/box"] = benchmark::Counter(
      static_cast<double>(boxes.size()), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  double pixels = 0.0, hidden = 0.0;
  for (const std::uint32_t count : counts) {
    pixels += count;
    hidden += count == 0 ? 1.0 : 0.0;
  }
  state.counters["pixels/box"] = pixels / static_cast<double>(counts.size());
  state.counters["hidden"] = hidden / static_cast<double>(counts.size());
}

void ask_software(benchmark::State& state, const Scene& scene, bool drawn, bool each) {
  hlod::SoftwareDevice device;
  ask(state, scene, device, drawn, each);
}
void ask_virtual(benchmark::State& state, const Scene& scene) {
  hlod::VirtualDevice device(hlod::device_preset("modern"));
  ask(state, scene, device, true, false);
}
void ask_recording(benchmark::State& state, const Scene& scene) {
  hlod::SoftwareDevice device;
  hlod::RecordingDevice recorder(device);
  ask(state, scene, recorder, true, false);
}

void add(const std::string& name, const std::function<void(benchmark::State&)>& body) {
  benchmark::RegisterBenchmark(name.c_str(), [body](benchmark::State& state) {
    try {
      body(state);
    } catch (const std::exception& error) {
      state.SkipWithError(error.what());
    }
  })->Unit(benchmark::kMillisecond);
}

void add_all() {
  for (const Scene& scene : scenes()) {
    const std::string name = scene.name;
    for (const std::size_t level : {0U, 1U, 2U})
      add(fmt::format("draw/{}/level:{}", name, level),
          [&scene, level](benchmark::State& state) { draw(state, scene, level, 0.0F, false); });
    add("draw_morphed/" + name, [&scene](benchmark::State& state) { draw(state, scene, 1, 0.5F, false); });
    add("draw_items/" + name, [&scene](benchmark::State& state) { draw(state, scene, 0, 0.0F, true); });
    add("ask_empty/" + name, [&scene](benchmark::State& state) { ask_software(state, scene, false, false); });
    add("ask/" + name, [&scene](benchmark::State& state) { ask_software(state, scene, true, false); });
    add("ask_each/" + name, [&scene](benchmark::State& state) { ask_software(state, scene, true, true); });
    add("ask_virtual/" + name, [&scene](benchmark::State& state) { ask_virtual(state, scene); });
    add("ask_recording/" + name, [&scene](benchmark::State& state) { ask_recording(state, scene); });
  }
}

}  // namespace
}  // namespace occlod::bench

int main(int argc, char** argv) { return occlod::bench::run_benchmarks(argc, argv, occlod::bench::add_all); }
