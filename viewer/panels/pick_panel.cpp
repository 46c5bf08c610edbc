// The picked triangle and the split that made it.
#include <fmt/format.h>

#include <cmath>

#include "controls.h"
#include "panels.h"

namespace occlod::viewer {
namespace {

void draw_row(const char* name, const std::string& value) {
  ImGui::TextDisabled("%s", name);
  ImGui::SameLine(ImGui::GetWindowContentRegionMax().x * 0.42F);
  ImGui::TextUnformatted(value.c_str());
}

void draw_split(const PlacedObject& object, SplitId split) {
  const Hierarchy& hierarchy = *object.mesh->hierarchy;
  const SplitNode& node = hierarchy.node(split);
  const SplitStar star = hierarchy.star(split);
  draw_row("Split", fmt::format("{} of {}", grouped(split), grouped(static_cast<double>(hierarchy.split_count()))));
  draw_row("Level", std::to_string(object.mesh->levels[split]));
  draw_row("Dependencies", std::to_string(star.dependencies().size()));
  draw_row("Faces", fmt::format("{} added, {} removed", star.inserted_count(), star.removed_count()));
  draw_row("Error", fmt::format("{:.3g}, guaranteed {:.3g}", node.error, node.guaranteed_error));
  draw_row("Subtree radius", fmt::format("{:.3g}", node.sphere.radius));
  const NormalCone cone = node.cone();
  draw_row("Normals", cone.culls() ? fmt::format("within {:.0f} degrees", std::acos(cone.cos_angle) * 57.29578F)
                                   : std::string("in all directions, no cone"));
}

}  // namespace

void draw_pick(Panels& panels) {
  const auto& pick = panels.session.state().pick;
  if (!pick || !begin_section(panels, "Picked")) return;
  for (const PlacedObject& object : *panels.session.state().objects) {
    if (object.id != pick->object) continue;
    draw_row("Object", object.name);
    draw_row("Triangle", fmt::format("{}, {}, {}", pick->triangle.x, pick->triangle.y, pick->triangle.z));
    if (pick->split == no_id)
      draw_row("Split", "none, part of the base mesh");
    else
      draw_split(object, pick->split);
  }
  draw_button(panels, "unpick");
}

}  // namespace occlod::viewer
