// bench_build: how quickly hierarchies are built, how large they are and how much memory that takes.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <exception>
#include <string>
#include <thread>

#include "occlod/build_hierarchy.h"
#include "support/bench_meshes.h"
#include "support/hierarchy_hash.h"
#include "support/memory.h"
#include "support/run_benchmarks.h"

namespace occlod::bench {
namespace {

void report_memory(benchmark::State& state, const Hierarchy& hierarchy, std::uint64_t before) {
  const auto vertices = static_cast<double>(hierarchy.vertex_count());
  state.counters["bytes/vertex"] = static_cast<double>(hierarchy.bytes()) / vertices;
  const auto peak = peak_bytes();
  if (!peak || before == 0) return;
  state.counters["peak_MiB"] = static_cast<double>(*peak) / (1024.0 * 1024.0);
  state.counters["peak_bytes/vertex"] = static_cast<double>(*peak - before) / vertices;
}

// Argument: the number of threads. Label: the hash of the result, which has to be the same in every iteration.
void build(benchmark::State& state, const std::string& name) {
  try {
    const TriangleMesh mesh = load_bench_mesh(name);
    BuildOptions options;
    options.threads = static_cast<int>(state.range(0));
    const std::uint64_t before = restart_peak().value_or(0);
    std::uint64_t hash = 0;
    Hierarchy hierarchy;
    for ([[maybe_unused]] auto iteration : state) {
      hierarchy = build_hierarchy(mesh, options);
      state.PauseTiming();
      const std::uint64_t found = hash_of(hierarchy);
      if (hash != 0 && found != hash) return state.SkipWithError("two builds of one mesh differ");
      hash = found;
      report_memory(state, hierarchy, before);
      hierarchy = {};  // or the next build would hold two
      state.ResumeTiming();
    }
    state.SetLabel(fmt::format("{:016x}", hash));
    state.counters["tri/s"] =
        benchmark::Counter(static_cast<double>(mesh.triangle_count()), benchmark::Counter::kIsIterationInvariantRate);
  } catch (const std::exception& error) {
    state.SkipWithError(error.what());
  }
}

void add_all() {
  for (const std::string& name :
       available({"planet:7", "planet:8", "planet:9", "scans/armadillo_100k.obj", "scans/bun_zipper.ply",
                  "scans/dragon_vrip_res2.ply", "scans/turbineblade.ply"})) {
    auto& registered = *benchmark::RegisterBenchmark(("build/" + name).c_str(), build, name);
    registered.Unit(benchmark::kMillisecond)->UseRealTime()->ArgName("threads")->Arg(1);
    if (const unsigned cores = std::thread::hardware_concurrency(); cores > 1) registered.Arg(cores);
  }
}

}  // namespace
}  // namespace occlod::bench

int main(int argc, char** argv) { return occlod::bench::run_benchmarks(argc, argv, occlod::bench::add_all); }
