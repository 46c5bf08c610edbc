#include "cover/scene_nodes.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "chosen_views.h"
#include "hlod/draw/cover_model.h"
#include "hlod/draw/frame_scene.h"
#include "hlod/draw/query_value.h"
#include "occlod/device.h"
#include "occlod/node_store.h"
#include "occlod/scene.h"
#include "occlod/traverser.h"
#include "occlod/view.h"

namespace occlod::bench {
namespace {

using hlod::NodeId;

class Walk {
 public:
  Walk(const hlod::Hlod& hlod, double tolerance_px, CoverCounts& counts)
      : placed_{&hlod}, tolerance_px_(tolerance_px), counts_(counts) {}

  void draw_frame(const View& view) {
    const hlod::ObjectFrame frame(view, placed_, {});
    device_.begin_frame(view, {&placed_, 1});
    covered_ = covered_of_scene_ = 0.0;
    scene_share_ = hlod::root_share(*placed_.hlod, frame);
    reached_.assign(placed_.hlod->node_count(), false);
    for (const NodeId root : placed_.hlod->data().roots) reach(frame, root);
    while (!queue_.empty()) visit(frame, queue_.pop().ref.node);
    device_.end_frame();
  }

 private:
  void reach(const hlod::ObjectFrame& frame, NodeId n) {
    if (reached_[n]) return;
    reached_[n] = true;
    const Box& box = node(n).box;
    if (frame.may_be_inside(box)) queue_.push({frame.distance(box), {0, n}, 0});
  }

  void visit(const hlod::ObjectFrame& frame, NodeId n) {
    count(frame, n);
    if (node(n).children == 0 || frame.error_px(node(n)) <= tolerance_px_) return draw(frame, n);
    for (const NodeId child : placed_.hlod->children(n)) reach(frame, child);
  }

  void count(const hlod::ObjectFrame& frame, NodeId n) {
    const std::optional<double> pixels = frame.box_pixels(node(n));
    if (!pixels || !(*pixels > 0.0)) return;
    const hlod::BoxRef box{0, node(n).box};
    const double share = frame.coverage(box.box);
    counts_.add({covered_, share, covered_of_scene_, std::min(1.0, share / scene_share_),
                 device_.wait(device_.ask({&box, 1}))[0] == 0});
  }

  void draw(const hlod::ObjectFrame& frame, NodeId n) {
    if (node(n).triangles == 0) return;
    const hlod::DrawRange all{0, 3 * node(n).triangles};
    device_.draw({.object = 0, .node = n, .ranges = {&all, 1}});
    const double ratio = hlod::coverage_ratio(static_cast<double>(node(n).area), hlod::box_area(node(n).box));
    const double share = hlod::mesh_coverage(frame.coverage(node(n).box), ratio);
    covered_ = hlod::covered_with(covered_, share);
    covered_of_scene_ = hlod::covered_with(covered_of_scene_, std::min(1.0, share / scene_share_));
  }

  [[nodiscard]] const hlod::Node& node(NodeId n) const { return placed_.hlod->data().nodes[n]; }

  hlod::PlacedHlod placed_;
  double tolerance_px_;
  CoverCounts& counts_;
  hlod::SoftwareDevice device_;
  hlod::DistanceQueue queue_;
  std::vector<bool> reached_;
  double covered_ = 0.0;           // c_scr
  double covered_of_scene_ = 0.0;  // the same of the part of the image that the scene covers
  double scene_share_ = 1.0;       // that part
};

}  // namespace

void count_scene_nodes(const SceneNodesOptions& options, CoverCounts& counts) {
  const SceneDescription scene = read_scene(options.scene);
  tool::ViewOptions views;
  views.path = options.path;
  const CameraPath path = tool::chosen_path(scene, views);
  const OhlodFile file = read_ohlod(options.hlod);
  file.hlod.require_all();
  const int frames = options.frames > 0 ? std::min(options.frames, path.frames) : path.frames;
  Walk walk(file.hlod, options.tolerance_px, counts);
  for (int i = 0; i < frames; ++i) walk.draw_frame(View(camera_at(path, i * path.frames / frames)));
}

}  // namespace occlod::bench
