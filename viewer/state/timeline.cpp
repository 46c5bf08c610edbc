#include "timeline.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "base/atomic_file.h"

namespace occlod::viewer {

void Timeline::add(const PictureRecord& record) {
  records_.push_back(record);
  if (records_.size() > capacity) records_.pop_front();
}

namespace {

// Returns empty columns unless cells are walked through.
std::string walked_columns(const PictureRecord& record) {
  if (!record.walked) return ",,,,";
  const WalkedFrame& walked = *record.walked;
  return fmt::format("{},{},{},{},{}", walked.cell, walked.shown, walked.late ? 1 : 0, walked.bytes_read,
                     walked.resident_bytes);
}

}  // namespace

void Timeline::write_csv(const std::filesystem::path& file) const {
  AtomicFile target(file);
  target.stream() << "picture,path_frame,refine_ms,occlusion_ms,upload_ms,draw_ms,budget,triangles,visible_triangles,"
                     "splits,forced_splits,queries,queries_hidden,max_quadric_error_px,max_error_px,memory_mb,hash,new_"
                     "splits,merged_splits,"
                     "changed_triangles,pending,uploaded_bytes,drawn_nodes,drawn_patches,rarn,delayed,blocked,"
                     "wasted_queries,frame_ms,stall_ms,cell,shown_cell,late,bytes_read,resident_bytes\n";
  for (const PictureRecord& r : records_) {
    target.stream() << fmt::format(
        "{},{},{:.3f},{:.3f},{:.3f},{:.3f},{},{},{},{},{},{},{},{:.4f},{:.4f},{:.1f},{:016x},{},{},{},{},{},{},{},{},{}"
        ",{},{},"
        "{:.4f},{:.4f},{}\n",
        r.picture, r.path_frame, r.refine_ms, r.occlusion_ms, r.cost.upload_ms, r.cost.draw_ms, r.budget, r.triangles,
        r.visible_triangles, r.splits, r.forced_splits, r.queries, r.queries_hidden, r.max_quadric_error_px,
        r.max_error_px, r.memory_mb, r.hash, r.new_splits, r.merged_splits, r.changed_triangles, r.pending ? 1 : 0,
        r.cost.uploaded_bytes, r.hlod.drawn_nodes, r.hlod.drawn_patches, r.hlod.rarn, r.hlod.delayed, r.hlod.blocked,
        r.hlod.wasted_queries, r.times.frame_ms, r.times.stall_ms, walked_columns(r));
  }
  target.commit();
}

double round_up(double value, double least) {
  while (std::isfinite(value))
    for (const double factor : {2.0, 2.5, 2.0}) {
      if (value <= least) return least;
      least *= factor;
    }
  return least;
}

double graph_top_ms(const std::deque<PictureRecord>& records, std::size_t first) {
  std::vector<double> totals;
  for (std::size_t i = first; i < records.size(); ++i) totals.push_back(records[i].total_ms());
  const auto place = totals.begin() + static_cast<std::ptrdiff_t>(totals.size() * 98 / 100);
  std::nth_element(totals.begin(), place, totals.end());
  return round_up(*place, 5.0);
}

double resident_memory_mb() {
  std::ifstream statm("/proc/self/statm");  // in pages: all, resident, ...
  double all = 0.0;
  double resident = 0.0;
  if (!(statm >> all >> resident)) return 0.0;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

}  // namespace occlod::viewer
