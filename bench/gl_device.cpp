// bench_gl_device: what draws, queries and answers cost the device `gl`, on a rough planet as an HLOD. llvmpipe draws
// on the calling thread unless LP_NUM_THREADS says otherwise; run it with 0 and 2.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <limits>
#include <memory>
#include <vector>

#include "gl/backend_options.h"
#include "occlod/base.h"
#include "occlod/build_hlod.h"
#include "occlod/gl.h"
#include "support/bench_meshes.h"
#include "support/run_benchmarks.h"

namespace occlod::bench {
namespace {

const hlod::Hlod& planet() {
  static const hlod::Hlod hlod = hlod::build_hlod(load_bench_mesh("planet:7"));
  return hlod;
}

// 1024 x 768 pixels; the planet fills the height.
View view() {
  Camera camera;
  camera.near = 0.1;
  camera.far = 10.0;
  return View(camera);
}

std::vector<hlod::BoxRef> boxes_of_level(std::size_t level) {
  const hlod::Level& nodes = planet().data().levels[level];
  std::vector<hlod::BoxRef> boxes;
  for (hlod::NodeId n = nodes.first_node; n < nodes.first_node + nodes.node_count; ++n)
    boxes.push_back({0, planet().node(n).box});
  return boxes;
}

struct Setting {
  bool quality = false;
  bool tiny = false;  // hardly any memory for meshes
  bool indirect = true;
  bool marks = true;
};

Box middle_eighth(const Box& box) {
  const glm::vec3 middle = 0.5F * (box.min + box.max), half = (box.max - box.min) / 16.0F;
  return {middle - half, middle + half};
}

// One device for each setting, kept: a new one would upload all meshes again.
gl::HlodDevice& device(const Setting& setting) {
  static const std::shared_ptr<gl::Context> context = gl::create_any_context();
  static std::array<std::unique_ptr<gl::HlodDevice>, 16> devices;
  auto& chosen = devices[(setting.quality ? 1U : 0U) + (setting.tiny ? 2U : 0U) + (setting.indirect ? 4U : 0U) +
                         (setting.marks ? 8U : 0U)];
  if (!chosen)
    chosen =
        gl::make_hlod_device(context,
                             {.quality = setting.quality,
                              .mesh_bytes = setting.tiny ? std::size_t{512} << 10 : gl::HlodDeviceOptions{}.mesh_bytes},
                             {.indirect = setting.indirect, .marks = setting.marks});
  return *chosen;
}

void begin(gl::HlodDevice& device) {
  const std::array<hlod::PlacedHlod, 1> objects{{{&planet()}}};
  device.begin_frame(view(), objects);
}

// Every node of a level, each in one range or patch by patch.
void draw_level(gl::HlodDevice& device, std::size_t level, bool patches, float morph) {
  const hlod::Level& nodes = planet().data().levels[level];
  std::vector<hlod::DrawRange> ranges;
  for (hlod::NodeId n = nodes.first_node; n < nodes.first_node + nodes.node_count; ++n) {
    ranges.clear();
    if (!patches) ranges.push_back({0, 3 * planet().node(n).triangles, morph});
    // Without the first triangle of each, so that they are not adjacent.
    for (const hlod::Patch& patch : planet().patches(n))
      if (patches && patch.index_count > 3) ranges.push_back({patch.first_index + 3, patch.index_count - 3, morph});
    device.draw({0, n, ranges});
  }
}

template <class Body>
void guarded(benchmark::State& state, const Body& body) {
  try {
    body();
  } catch (const Error& error) {
    state.SkipWithError(error.what());
  }
}

void per(benchmark::State& state, const char* name, std::size_t count) {
  using benchmark::Counter;
  state.counters[name] = Counter(static_cast<double>(count),
                                 Counter::kIsIterationInvariantRate | Counter::kInvert);  // seconds each
}

void empty_frame(benchmark::State& state) {
  guarded(state, [&] {
    gl::HlodDevice& gl = device({.quality = state.range(0) != 0});
    for ([[maybe_unused]] auto iteration : state) {
      begin(gl);
      benchmark::DoNotOptimize(gl.end_frame());
    }
  });
}

// Arguments: quality, level, patches by themselves, morphing, hardly any memory for meshes, many draws by one call.
void draw(benchmark::State& state) {
  guarded(state, [&] {
    gl::HlodDevice& gl = device({state.range(0) != 0, state.range(4) != 0, state.range(5) != 0});
    const auto level = static_cast<std::size_t>(state.range(1));
    for ([[maybe_unused]] auto iteration : state) {
      begin(gl);
      draw_level(gl, level, state.range(2) != 0, state.range(3) != 0 ? 0.5F : 0.0F);
      benchmark::DoNotOptimize(gl.end_frame());
    }
    state.counters["calls"] = static_cast<double>(gl.calls().draw_calls);
    per(state, "each_draw", planet().data().levels[level].node_count);
  });
}

enum class Asking { one_batch, one_by_one, waited, polled, one_sum };

// After the coarse planet is drawn, all finest nodes are asked about. Without what the drawing takes. Arguments:
// quality, batches by marks, only the middle eighth of each box, boxes at most.
void ask(benchmark::State& state, Asking asking) {
  guarded(state, [&] {
    gl::HlodDevice& gl = device({.quality = state.range(0) != 0, .marks = state.range(1) != 0});
    std::vector<hlod::BoxRef> boxes = boxes_of_level(0);
    if (state.range(2) != 0)
      for (hlod::BoxRef& box : boxes) box.box = middle_eighth(box.box);
    boxes.resize(std::min(boxes.size(), static_cast<std::size_t>(state.range(3))));
    std::vector<hlod::QueryId> queries;
    std::uint64_t pixels = 0;
    double min_wait = std::numeric_limits<double>::infinity();
    for ([[maybe_unused]] auto iteration : state) {
      state.PauseTiming();
      begin(gl);
      draw_level(gl, 2, false, 0.0F);
      benchmark::DoNotOptimize(gl.wait(gl.ask({boxes.data(), 1})));
      queries.clear();
      state.ResumeTiming();
      if (asking == Asking::one_batch) queries.push_back(gl.ask_each(boxes));
      if (asking == Asking::one_sum) queries.push_back(gl.ask(boxes));
      for (const hlod::BoxRef& box : boxes) {
        if (asking == Asking::one_batch || asking == Asking::one_sum) break;
        const auto start = std::chrono::steady_clock::now();
        queries.push_back(gl.ask({&box, 1}));
        if (asking == Asking::polled) static_cast<void>(gl.available(queries.front()));
        if (asking != Asking::waited) continue;
        pixels += gl.wait(queries.back()).front();
        queries.clear();
        const std::chrono::duration<double> wait = std::chrono::steady_clock::now() - start;
        min_wait = std::min(min_wait, wait.count());
      }
      for (const hlod::QueryId query : queries)
        for (const std::uint32_t count : gl.wait(query)) pixels += count;
      state.PauseTiming();
      benchmark::DoNotOptimize(gl.end_frame());
      state.ResumeTiming();
    }
    // Of a single box, where programs beside this one disturb the sum.
    if (asking == Asking::waited) state.counters["min_wait"] = min_wait;
    state.counters["pixels"] = static_cast<double>(pixels) / static_cast<double>(state.iterations());
    per(state, "each_box", boxes.size());
  });
}

// Draws and queries by turns, nothing waited for: what changing between them costs.
void by_turns(benchmark::State& state) {
  guarded(state, [&] {
    gl::HlodDevice& gl = device({.quality = state.range(0) != 0, .indirect = state.range(1) != 0});
    const hlod::Level& nodes = planet().data().levels[1];
    for ([[maybe_unused]] auto iteration : state) {
      begin(gl);
      for (hlod::NodeId n = nodes.first_node; n < nodes.first_node + nodes.node_count; ++n) {
        const hlod::BoxRef box{0, planet().node(n).box};
        static_cast<void>(gl.ask({&box, 1}));
        const hlod::DrawRange range{0, 3 * planet().node(n).triangles, 0.0F};
        gl.draw({0, n, {&range, 1}});
      }
      benchmark::DoNotOptimize(gl.end_frame());
    }
    per(state, "each_pair", nodes.node_count);
  });
}

void register_all() {
  const auto add = [](const char* name, auto function, auto... arguments) {
    auto& registered = *benchmark::RegisterBenchmark(name, function, arguments...);
    registered.Unit(benchmark::kMillisecond)->UseRealTime();
    // Of repetitions: the one that other programs have disturbed least.
    registered.ComputeStatistics(
        "min", [](const std::vector<double>& times) { return *std::min_element(times.begin(), times.end()); });
    return &registered;
  };
  add("empty_frame", empty_frame)->ArgName("quality")->Arg(0)->Arg(1);
  auto* const draws = add("draw", draw)->ArgNames({"quality", "level", "patches", "morph", "tiny", "indirect"});
  for (const int indirect : {0, 1}) {
    for (const int level : {0, 1, 2}) draws->Args({0, level, 0, 0, 0, indirect});
    draws->Args({0, 1, 1, 0, 0, indirect})->Args({0, 1, 0, 1, 0, indirect});
    draws->Args({0, 1, 0, 0, 1, indirect})->Args({1, 1, 0, 0, 0, indirect});
  }
  const std::vector<std::string> names{"quality", "marks", "small", "most"};
  auto* const batches = add("ask/one_batch", ask, Asking::one_batch)->ArgNames(names);
  for (const int marks : {0, 1})
    for (const int small : {0, 1})
      for (const int most : {2, 1000}) batches->Args({0, marks, small, most});
  batches->Args({1, 0, 0, 1000});
  add("ask/one_by_one", ask, Asking::one_by_one)->ArgNames(names)->Args({0, 0, 0, 1000});
  add("ask/polled", ask, Asking::polled)->ArgNames(names)->Args({0, 0, 0, 1000});
  add("ask/waited", ask, Asking::waited)->ArgNames(names)->Args({0, 0, 0, 1000})->Args({1, 0, 0, 1000});
  add("ask/one_sum", ask, Asking::one_sum)->ArgNames(names)->Args({0, 0, 0, 1000});
  auto* const turns = add("by_turns", by_turns)->ArgNames({"quality", "indirect"});
  for (const int indirect : {0, 1}) turns->Args({0, indirect})->Args({1, indirect});
}

int run(int argc, char** argv) {
  try {
    const std::shared_ptr<gl::Context> context = gl::create_any_context();
    benchmark::AddCustomContext("renderer", context->renderer());
    const char* threads = std::getenv("LP_NUM_THREADS");
    benchmark::AddCustomContext("LP_NUM_THREADS", threads != nullptr ? threads : "not set");
    const hlod::HlodView& data = planet().data();
    for (std::size_t level = 0; level < data.levels.size(); ++level)
      benchmark::AddCustomContext(fmt::format("level {}", level),
                                  fmt::format("{} nodes", data.levels[level].node_count));
  } catch (const Error& error) {
    fmt::print(stderr, "bench_gl_device: {}\n", error.what());
    return 1;
  }
  return run_benchmarks(argc, argv, register_all);
}

}  // namespace
}  // namespace occlod::bench

int main(int argc, char** argv) { return occlod::bench::run(argc, argv); }
