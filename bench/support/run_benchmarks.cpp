#include "support/run_benchmarks.h"

#include <benchmark/benchmark.h>

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace occlod::bench {
namespace {

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"  // there is no other that writes CSV

// It takes the columns from the first runs that it is given.
class CsvOfAllRuns : public benchmark::CSVReporter {
 public:
  void ReportRuns(const std::vector<Run>& runs) override { runs_.insert(runs_.end(), runs.begin(), runs.end()); }
  void Finalize() override { CSVReporter::ReportRuns(runs_); }

 private:
  std::vector<Run> runs_;
};

#pragma GCC diagnostic pop

bool has(std::span<char* const> arguments, std::string_view wanted) {
  for (const std::string_view argument : arguments)
    if (argument == wanted) return true;
  return false;
}

std::unique_ptr<CsvOfAllRuns> csv_if(bool wanted) { return wanted ? std::make_unique<CsvOfAllRuns>() : nullptr; }

}  // namespace

int run_benchmarks(int argc, char** argv, const std::function<void()>& add) {
  const std::span<char* const> arguments(argv, static_cast<std::size_t>(argc));
  const auto shown = csv_if(has(arguments, "--benchmark_format=csv"));
  const auto written = csv_if(has(arguments, "--benchmark_out_format=csv"));
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  add();
  benchmark::RunSpecifiedBenchmarks(shown.get(), written.get());
  benchmark::Shutdown();
  return 0;
}

}  // namespace occlod::bench
