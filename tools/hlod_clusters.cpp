#include "hlod_clusters.h"

#include <filesystem>

#include "hlod.h"
#include "interrupt.h"
#include "json_output.h"
#include "mesh/image_files.h"
#include "mesh/mesh_report.h"
#include "occlod/clusters.h"
#include "peak_bytes.h"
#include "stopwatch.h"

namespace occlod::tool {

void build_clusters(const ClusterJob& job, Progress& progress, bool json) {
  Stopwatch stopwatch;
  CleanMesh input = read_hlod_input(job.inputs, progress);
  leave_out_features(input);
  const double read_ms = stopwatch.restart();
  hlod::ClusterOptions options;
  options.max_triangles = job.max_triangles;
  options.error_bound = job.error_bound;
  options.threads = job.threads;
  options.progress = [&progress, what = "building " + job.output](double done) {
    progress.show(what, done);
    return true;
  };
  const hlod::ClusterLod lod = hlod::build_clusters(input.mesh, options);
  const double build_ms = stopwatch.restart();
  std::vector<std::string> left_out;
  write_interruptibly(job.output, 12 * lod.stored_triangles(), progress, [&] {
    left_out = hlod::write_clusters(job.output, lod, {job.compresses, folder_of(job.inputs[0])});
  });
  const double write_ms = stopwatch.milliseconds();
  progress.clear();

  Json result = {{"inputs", job.inputs},
                 {"file", job.output},
                 {"triangles", lod.input_triangles},
                 {"levels", lod.clusters.back().level + 1},
                 {"groups", lod.groups.size()},
                 {"clusters", lod.clusters.size()},
                 {"stored_triangles", lod.stored_triangles()},
                 {"vertices", lod.vertices.positions.size()},
                 {"cluster_triangles", job.max_triangles},
                 {"file_bytes", std::filesystem::file_size(job.output)},
                 {"read_ms", read_ms},
                 {"build_ms", build_ms},
                 {"write_ms", write_ms},
                 {"triangles_per_s", 1e3 * static_cast<double>(lod.input_triangles) / build_ms},
                 {"peak_bytes", peak_bytes()}};
  if (!left_out.empty()) result["images_left_out"] = left_out;
  result["report"] = to_json(input.report);
  if (json) return print_json(result);
  print_lines(result);
  print_lines(input.report);
}

}  // namespace occlod::tool
