// Describes the selected object, and the picked triangle with the split or node that it comes from.
#include <fmt/format.h>

#include <algorithm>
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

void draw_placement(Panels& panels, const PlacedObject& object) {
  panels.drawn.insert({"place", "two_sided"});
  const double radius = bounds_of(object).radius;
  if (glm::dvec3 position = object.placement.position; draw_vector("Position", position, 0.005 * radius))
    panels.perform("place", {{"object", object.id}, {"position", as_json(position)}});
  if (glm::dvec3 rotation = object.placement.rotation_deg; draw_vector("Rotation", rotation, 0.5))
    panels.perform("place", {{"object", object.id}, {"rotation", as_json(rotation)}});
  draw_label("Scale");
  double scale = object.placement.scale;
  const double least = 1e-6, most = 1e6;
  if (ImGui::DragScalar("##scale", ImGuiDataType_Double, &scale, static_cast<float>(0.005 * scale), &least, &most,
                        "%.4g", ImGuiSliderFlags_AlwaysClamp))
    panels.perform("place", {{"object", object.id}, {"scale", scale}});
  bool two_sided = object.two_sided;
  if (ImGui::Checkbox("Two-sided", &two_sided))
    panels.perform("two_sided", {{"object", object.id}, {"value", two_sided}});
  draw_help_of_item("Both sides of triangles are visible: no back-face culling");
  ImGui::SameLine();
  draw_button(panels, "frame_selected");
  ImGui::SameLine();
  draw_button(panels, "close");
}

void draw_pick(const Session& session, const PlacedObject& object, const Pick& pick) {
  if (object.hlod) return draw_node(session, object, pick);
  draw_row("Triangle", fmt::format("{}, {}, {}", pick.triangle.x, pick.triangle.y, pick.triangle.z));
  if (pick.split == no_id)
    draw_row("Split", "none, part of the base mesh");
  else
    draw_split(object, pick.split);
}

}  // namespace

void draw_selected(Panels& panels, const Layout& layout) {
  const State& state = panels.session.state();
  const auto objects = state.objects;  // a copy, because actions replace it
  const auto selected = std::ranges::find(*objects, state.selected, &PlacedObject::id);
  if (selected == objects->end()) return;
  const float margin = 10.0F * panels.scale;
  const float width = std::min(310.0F * panels.scale, layout.view.width() - 2.0F * margin);
  ImGui::SetNextWindowPos(ImVec2(layout.view.high.x - margin, layout.view.high.y - margin), ImGuiCond_Always,
                          ImVec2(1.0F, 1.0F));
  ImGui::SetNextWindowSizeConstraints(ImVec2(width, 0.0F), ImVec2(width, layout.view.height() - 2.0F * margin));
  ImGui::SetNextWindowBgAlpha(0.97F);
  bool open = true;
  if (ImGui::Begin(
          (selected->name + "###selected").c_str(), &open,
          ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoFocusOnAppearing)) {
    if (state.pick && state.pick->object == selected->id) draw_pick(panels.session, *selected, *state.pick);
    draw_placement(panels, *selected);
    panels.drawn.insert("unpick");
  }
  ImGui::End();
  if (!open) panels.perform("unpick");
}

}  // namespace occlod::viewer
