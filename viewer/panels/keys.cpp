#include "keys.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace occlod::viewer {
namespace {

nlohmann::json flip(const char* setting) { return {{"do", "flip"}, {"setting", setting}}; }
nlohmann::json from(const char* side) { return {{"do", "view_from"}, {"side", side}}; }

}  // namespace

const std::vector<KeyBinding>& key_bindings() {
  constexpr int control = GLFW_MOD_CONTROL;
  static const std::vector<KeyBinding> bindings = {
      {GLFW_KEY_F1, 0, "F1", "this list", flip("help")},
      {GLFW_KEY_TAB, 0, "Tab", "sidebar", flip("sidebar")},
      {GLFW_KEY_G, 0, "G", "numbers and time graph", flip("graph")},
      {GLFW_KEY_HOME, 0, "Home", "fit the whole scene", {{"do", "frame_all"}}},
      {GLFW_KEY_F, 0, "F", "fit the selected object", {{"do", "frame_selected"}}},
      {GLFW_KEY_KP_1, 0, "Numpad 1", "from the front", from("front")},
      {GLFW_KEY_KP_3, 0, "Numpad 3", "from the right", from("right")},
      {GLFW_KEY_KP_7, 0, "Numpad 7", "from the top", from("top")},
      {GLFW_KEY_KP_5, 0, "Numpad 5", "orthographic or perspective", {{"do", "orthographic"}}},
      {GLFW_KEY_M, 0, "M", "orbit, fly or walk", flip("steering")},
      {GLFW_KEY_C, 0, "C", "next colour mode", flip("color_by"), flip("hlod_color_by"), flip("cells_color_by")},
      {GLFW_KEY_V, 0, "V", "smooth or flat shading", flip("shading")},
      {GLFW_KEY_X, 0, "X", "wireframe", flip("wire")},
      {GLFW_KEY_O, 0, "O", "next occlusion backend, or strategy of an HLOD", flip("occlusion"), flip("strategy"),
       "O does nothing with view cells, which need no queries; switch Walk off, or split the screen (T), to refine"},
      {GLFW_KEY_Z, 0, "Z", "freeze the refinement", flip("freeze")},
      {GLFW_KEY_T, 0, "T", "split screen: with and without occlusion, or two strategies", flip("compare")},
      {GLFW_KEY_I, 0, "I", "bird's-eye inset", flip("birdseye")},
      {GLFW_KEY_U, 0, "U", "occluder inset", flip("occluder"),
       "U does nothing with an HLOD, which asks about boxes instead; Boxes: asked shows them",
       "U does nothing with view cells, for which no occluder is drawn; switch Walk off to refine"},
      {GLFW_KEY_ESCAPE, 0, "Esc", "clear the picked triangle", {{"do", "unpick"}}},
      {GLFW_KEY_DELETE, 0, "Del", "close the selected object", {{"do", "close"}}},
      {GLFW_KEY_Q, control, "Ctrl + Q", "quit", {{"do", "quit"}}},
  };
  return bindings;
}

Shown shown_in(const Session& session) {
  const State& state = session.state();
  if (are_hlods(*state.objects)) return Shown::hlods;
  if (!state.settings.cells.walk || !session.cells_fit()) return Shown::meshes;
  return state.settings.compare ? Shown::cells_beside_meshes : Shown::cells;
}

const nlohmann::json& action_of(const KeyBinding& binding, Shown shown) {
  if (shown == Shown::hlods && !binding.with_hlods.is_null()) return binding.with_hlods;
  if (shown == Shown::cells && !binding.with_cells.is_null()) return binding.with_cells;
  if (shown == Shown::cells_beside_meshes && binding.with_cells.is_object()) return binding.with_cells;
  return binding.action;
}

}  // namespace occlod::viewer
