#include "render_path.h"

#include <fmt/format.h>

#include <optional>
#include <utility>
#include <vector>

#include "beside_hlod.h"
#include "explanation.h"
#include "interrupt.h"
#include "occlod/picture.h"
#include "render_report.h"

namespace occlod::tool {
namespace {

void print_header(Following following) {
  fmt::print("{:>5}  {:>9}  {:>9}  {:>7}  {:>9}  {:>9}  {:>12}  {:>8}  ", "frame", "triangles", "visible", "share %",
             "queries", "refine ms", "occlusion ms", "draw ms");
  if (following == Following::frame_to_frame)
    fmt::print("{:>10}  {:>13}  {:>17}  {:>7}  ", "new splits", "merged splits", "changed triangles", "pending");
  fmt::print("hash\n");
}

void print_row(const Json& frame, Following following) {
  fmt::print("{:>5}  {:>9}  {:>9}  {:>7.1f}  {:>9}  {:>9.2f}  {:>12.2f}  {:>8.2f}  ", frame["frame"].get<int>(),
             frame["triangles"].get<std::size_t>(), frame["visible_triangles"].get<std::size_t>(),
             100.0 * frame["visible_share"].get<double>(), frame["queries"].get<std::size_t>(),
             frame["refine_ms"].get<double>(), frame["occlusion_ms"].get<double>(), frame["draw_ms"].get<double>());
  if (following == Following::frame_to_frame)
    fmt::print("{:>10}  {:>13}  {:>17}  {:>7}  ", frame["new_splits"].get<std::size_t>(),
               frame["merged_splits"].get<std::size_t>(), frame["changed_triangles"].get<std::size_t>(),
               frame["pending"].get<bool>() ? "yes" : "no");
  fmt::print("{}\n", frame["hash"].get<std::string>());
}

}  // namespace

std::filesystem::path numbered(const std::filesystem::path& file, int frame) {
  std::filesystem::path name = file.stem();
  name += fmt::format("_{:05}", frame);
  name += file.extension();
  return file.parent_path() / name;
}

void render_path(const RenderInput& input, const RefineOptions& options, RefineWay& way, const PathOutput& output) {
  Measurement measurement(input.objects, output.following);
  std::optional<BesideHlod> beside;
  if (!output.beside.empty()) beside.emplace(input.objects, input.path->frames);
  Json frames = Json::array();
  if (!output.json) print_header(output.following);
  for (int i = 0; i < input.path->frames; ++i) {
    if (!output.png.empty()) note_interrupts();
    const View view(camera_at(*input.path, i));
    measurement.begin();
    for (int round = 0; round < output.repeat; ++round) way.repeat(measurement, view, options);
    Json frame = {{"frame", i}};
    frame.update(stats_of(measurement));
    if (const std::optional<double> ms = way.show(measurement.items().depth)) frame["show_ms"] = *ms;
    if (output.following == Following::frame_to_frame) frame.update(changes_of(measurement.refinement().stats));
    frame["camera"] = to_json(view.camera());
    if (way.chooser() != nullptr) frame["auto"] = to_json(*way.chooser());
    if (!output.png.empty())
      write_png(numbered(output.png, i),
                shade(measurement.items(), measurement.objects(), view, {.textures = output.textures}));
    if (!output.json) print_row(frame, output.following);
    if (output.explain) print_explanation(*way.chooser(), measurement.refinement().stats, input.objects);
    if (beside) beside->add(view, measurement);
    frames.push_back(std::move(frame));
  }
  output.files->commit();
  const std::vector<WayCost> ways = beside ? costs_of_ways(*beside, output.beside) : std::vector<WayCost>();
  if (!output.json) {
    if (beside) print_ways(ways);
    return;
  }
  Json report = asked_of(input, options, way);
  report["frame_to_frame"] = output.following == Following::frame_to_frame;
  if (output.following == Following::frame_to_frame) report.update(following_asked_of(options));
  report["frames"] = std::move(frames);
  if (beside) report["splits_or_hlod"] = to_json(ways);
  print_json(report);
}

}  // namespace occlod::tool
