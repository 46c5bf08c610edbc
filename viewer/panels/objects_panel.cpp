// Lists the open objects.
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
  draw_help_of_item((object.name + "\n" + about(object)).c_str());  // the sidebar cuts long names off
  ImGui::PopID();
}

}  // namespace

void draw_objects(Panels& panels) {
  const auto objects = panels.session.state().objects;  // a copy, because actions replace it
  if (objects->empty() || !begin_section(panels, "Objects")) return;
  for (const PlacedObject& object : *objects) draw_row(panels, object);
}

}  // namespace occlod::viewer
