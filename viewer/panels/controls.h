// Controls made from the tables of settings and commands.
#pragma once

#include <string>

#include "panels.h"
#include "setting_table.h"

namespace occlod::viewer {

// A slider, box, list or field, with its label before it and its help when hovered.
void draw_setting(Panels& panels, const Setting& setting);
void draw_setting(Panels& panels, const char* name);

// A button that performs a command; true when it was pressed. `width` 0: as wide as its text, -1: what is left.
bool draw_button(Panels& panels, const char* command, const nlohmann::json& arguments = nlohmann::json::object(),
                 const char* label = nullptr, float width = 0.0F);

// A label in the first column; what comes next stands in the second.
void draw_label(const char* text);
// A name, and a value that begins at this share of the width.
void draw_row(const char* name, const std::string& value, float column = 0.42F);
// Three numbers to drag; true when they have been changed. `speed`: a pixel.
bool draw_vector(const char* label, glm::dvec3& value, double speed);
[[nodiscard]] nlohmann::json as_json(const glm::dvec3& v);
void draw_help_of_item(const char* text);
// "12,345".
[[nodiscard]] std::string grouped(double number);
// A section of the sidebar that folds; true when it is open.
bool begin_section(Panels& panels, const char* title, bool open = true);

}  // namespace occlod::viewer
