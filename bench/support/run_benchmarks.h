// The end of every main() that uses Google Benchmark.
#pragma once

#include <functional>

namespace occlod::bench {

// Runs what `add` registers, as the options of Google Benchmark on the command line say. The exit status: 2 where there
// are others, before anything is added. A table as CSV (--benchmark_format, --benchmark_out_format) is printed at the
// end, with the counters of all rows as columns; Google Benchmark's own ends the program at the first counter that the
// first row does not have.
[[nodiscard]] int run_benchmarks(int argc, char** argv, const std::function<void()>& add);

}  // namespace occlod::bench
