// Draws controls from the tables of settings and commands.
#pragma once

#include <string>
#include <string_view>

#include "panels.h"
#include "setting_table.h"

namespace occlod::viewer {

// Draws a slider, box, list or field after its label, with its help when hovered.
void draw_setting(Panels& panels, const Setting& setting);
void draw_setting(Panels& panels, const char* name);

// Draws a button that performs a command. Returns true when it was pressed. `width` 0 fits the text, -1 fills the rest.
bool draw_button(Panels& panels, const char* command, const nlohmann::json& arguments = nlohmann::json::object(),
                 const char* label = nullptr, float width = 0.0F);

// Draws a label in the first column, with its help when hovered; the next item stands in the second.
void draw_label(const char* text, const char* help = nullptr);
// Draws a name, and a value that begins at the share `column` of the width, or behind a longer name.
void draw_row(const char* name, const std::string& value, float column = 0.42F);
// Draws three numbers to drag, which change by `speed` per pixel. Returns true when they have been changed.
bool draw_vector(const char* label, glm::dvec3& value, double speed);
[[nodiscard]] nlohmann::json as_json(const glm::dvec3& v);
void draw_help_of_item(const char* text);
// Explains a number of the strip at the bottom by its name there.
[[nodiscard]] const char* help_of_number(std::string_view name);
// Formats numbers like "12,345".
[[nodiscard]] std::string grouped(double number);
// Draws the head of a section of the sidebar that folds. Returns true when it is open.
bool begin_section(Panels& panels, const char* title, bool open = true);

}  // namespace occlod::viewer
