// Draws the panels around the view. Every control performs an action of the session; none changes its state directly.
#pragma once

#include <imgui.h>

#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "draw/depth_texture.h"
#include "palette.h"
#include "session.h"

namespace occlod::viewer {

// Holds a rectangle in the window's coordinates.
struct Area {
  ImVec2 low{0.0F, 0.0F};
  ImVec2 high{0.0F, 0.0F};

  [[nodiscard]] float width() const { return high.x - low.x; }
  [[nodiscard]] float height() const { return high.y - low.y; }
  [[nodiscard]] bool holds(const ImVec2& p) const {
    return p.x >= low.x && p.x < high.x && p.y >= low.y && p.y < high.y;
  }
};

// Holds the places of all panels.
struct Layout {
  Area sidebar;
  Area graph;
  Area view;  // the rest
  // Lie inside the view: one, or two with the split screen, with the proportions of the picture.
  std::vector<Area> pictures;
};

// Holds what is typed into text fields until it is used.
struct Fields {
  std::string open_folder;
  std::string open_file;
  std::string save_scene = "scene.json";
  std::string screenshot = "occlod-view.png";
  std::string mesh = "occlod-view.ply";
  std::string csv = "occlod-view.csv";
  std::string bookmark = "view 1";
  std::string path = "path 1";
  std::string pictures = "pictures";
  bool opens = false;             // the dialogue "open" is there
  bool types_path = false;        // its field has the focus
  ImVector<ImWchar> typed_early;  // before that
};

struct Insets {
  ImTextureID birdseye = nullptr;
  const DepthTexture* occluder = nullptr;  // null: none
};

struct Panels {
  Session& session;
  Fields fields;
  float scale = 1.0F;  // of text and panels
  Insets insets;
  bool unfold = false;          // opens all sections of the sidebar
  std::set<std::string> drawn;  // settings and commands that had a control since this was last cleared

  // Returns whether keys type text, or belong to a dialogue: they are not for the view.
  [[nodiscard]] bool takes_keys() const { return fields.opens || ImGui::GetIO().WantTextInput; }

  // Performs {"do": command, ...arguments}.
  void perform(const char* command, nlohmann::json arguments = nlohmann::json::object());
};

[[nodiscard]] Layout lay_out(const Session& session, const ImVec2& window, float scale);

// Draws everything, with the pictures of the sides as textures. Call it between ImGui::NewFrame and ImGui::Render.
void draw_panels(Panels& panels, const Layout& layout, const std::vector<ImTextureID>& pictures);

// Each of these draws one part, and has its own source.
void draw_files(Panels& panels);
void draw_output(Panels& panels);
void draw_first(Panels& panels);
void draw_start(Panels& panels, const Layout& layout);
void draw_open_dialogue(Panels& panels, const Layout& layout);
void draw_objects(Panels& panels);
void draw_refinement(Panels& panels);
void draw_hlod(Panels& panels);
void draw_cells(Panels& panels);
void draw_auto(Panels& panels);
void draw_look(Panels& panels);
// Draws, over the view, the placement of the selected object and what was picked of it.
void draw_selected(Panels& panels, const Layout& layout);
void draw_study(Panels& panels);
void draw_distance(const Session& session, const Layout& layout);
void draw_camera(Panels& panels);
void draw_paths(Panels& panels);
void draw_window_settings(Panels& panels);
void draw_numbers(Panels& panels, const Area& area);
void draw_insets(Panels& panels, const Layout& layout);
void draw_legend(Panels& panels, const Layout& layout);
// Returns what the colours of the view stand for; nothing where they tell nothing.
[[nodiscard]] std::vector<LegendEntry> legend_of(const Session& session);
void draw_messages(Panels& panels, const Layout& layout);
void draw_help(Panels& panels);

}  // namespace occlod::viewer
