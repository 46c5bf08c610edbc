// Describes the picked triangle and the split that made it.
#include <fmt/format.h>

#include <cmath>

#include "controls.h"
#include "palette.h"
#include "panels.h"

namespace occlod::viewer {
namespace {

void draw_split(const PlacedObject& object, SplitId split) {
  const Hierarchy& hierarchy = *object.mesh->hierarchy;
  const SplitNode& node = hierarchy.node(split);
  const SplitFaces faces = hierarchy.faces_of(split);
  draw_row("Split", fmt::format("{} of {}", grouped(split), grouped(static_cast<double>(hierarchy.split_count()))));
  draw_row("Level", std::to_string(object.mesh->levels[split]));
  draw_row("Dependencies", std::to_string(faces.dependencies.size()));
  draw_row("Faces", fmt::format("{} added, {} removed", faces.inserted.size(), faces.removed.size()));
  draw_row("Error", fmt::format("{:.3g}, guaranteed {:.3g}", node.error, node.guaranteed_error));
  draw_row("Subtree radius", fmt::format("{:.3g}", node.sphere.radius));
  const NormalCone cone = node.cone();
  draw_row("Normals", cone.culls() ? fmt::format("within {:.0f} degrees", std::acos(cone.cos_angle) * 57.29578F)
                                   : std::string("in all directions, no cone"));
}

void draw_node(const Session& session, const PlacedObject& object, const Pick& pick) {
  const hlod::Hlod& hlod = *object.hlod->hlod;
  const hlod::Node& node = hlod.node(pick.node);
  draw_row("Node", fmt::format("{} of {}", grouped(pick.node), grouped(static_cast<double>(hlod.node_count()))));
  draw_row("Level", fmt::format("{} of {}", node.level, hlod.level_count()));
  draw_row("Triangles", grouped(node.triangles));
  draw_row("Parents, children", fmt::format("{}, {}", hlod.patches(pick.node).size(), node.children));
  draw_row("Error", fmt::format("{:.3g}, guaranteed {:.3g}", node.error, node.guaranteed_error));
  const auto& frame = session.frame();
  if (!frame || frame->hlod_sides.empty()) return;
  for (const hlod::DrawnNode& draw : frame->hlod_sides[0].front->frame.draws) {
    if (draw.node != pick.node || (*frame->job.objects)[draw.object].id != object.id) continue;
    const double px = error_px(draw, object, View(frame->job.camera));
    draw_row("On the screen", fmt::format("{:.2f} px, counted {:.0f} %", px, 100.0F * draw.bias));
    draw_row("State", word_of(drawn_as(draw)));
    return;
  }
  draw_row("State", "not drawn");
}

}  // namespace

void draw_pick(Panels& panels) {
  const auto& pick = panels.session.state().pick;
  if (!pick || !begin_section(panels, "Picked")) return;
  for (const PlacedObject& object : *panels.session.state().objects) {
    if (object.id != pick->object) continue;
    draw_row("Object", object.name);
    if (!object.hlod)
      draw_row("Triangle", fmt::format("{}, {}, {}", pick->triangle.x, pick->triangle.y, pick->triangle.z));
    if (object.hlod)
      draw_node(panels.session, object, *pick);
    else if (pick->split == no_id)
      draw_row("Split", "none, part of the base mesh");
    else
      draw_split(object, pick->split);
  }
  draw_button(panels, "unpick");
}

}  // namespace occlod::viewer
