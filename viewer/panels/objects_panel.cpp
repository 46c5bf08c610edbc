// Lists the open objects and their placements.
#include <fmt/format.h>

#include <cstdint>

#include "controls.h"
#include "panels.h"

namespace occlod::viewer {
namespace {

std::string about(const PlacedObject& object) {
  const auto text = [](std::uint64_t triangles, std::size_t bytes) {
    return grouped(static_cast<double>(triangles)) + " triangles, " + grouped(static_cast<double>(bytes) / 1e6) + " MB";
  };
  if (!object.hlod) return text(object.mesh->hierarchy->input_triangle_count(), object.mesh->hierarchy->bytes());
  const hlod::Hlod& hlod = *object.hlod->hlod;
  return text(hlod.data().input_triangle_count, hlod.bytes()) +
         fmt::format(", {} nodes in {} levels", grouped(static_cast<double>(hlod.node_count())), hlod.level_count());
}

void draw_row(Panels& panels, const PlacedObject& object) {
  ImGui::PushID(static_cast<int>(object.id));
  panels.drawn.insert({"show", "select"});
  bool shown = object.shown;
  if (ImGui::Checkbox("##shown", &shown)) panels.perform("show", {{"object", object.id}, {"shown", shown}});
  draw_help_of_item("Show or hide this object");
  ImGui::SameLine();
  const bool selected = panels.session.state().selected == object.id;
  if (ImGui::Selectable(object.name.c_str(), selected)) panels.perform("select", {{"object", object.id}});
  draw_help_of_item(about(object).c_str());
  ImGui::PopID();
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

}  // namespace

void draw_objects(Panels& panels) {
  const auto objects = panels.session.state().objects;  // a copy, because actions replace it
  if (objects->empty() || !begin_section(panels, "Objects")) return;
  const PlacedObject* selected = nullptr;
  for (const PlacedObject& object : *objects) {
    draw_row(panels, object);
    if (panels.session.state().selected == object.id) selected = &object;
  }
  if (selected != nullptr) draw_placement(panels, *selected);
}

}  // namespace occlod::viewer
