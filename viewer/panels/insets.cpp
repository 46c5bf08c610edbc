// Draws over the view: insets on the right, the legend on the left, the captions of the split screen.
#include <fmt/format.h>

#include <algorithm>

#include "controls.h"
#include "hlod_strategies.h"
#include "palette.h"
#include "panels.h"
#include "theme.h"

namespace occlod::viewer {
namespace {

constexpr ImGuiWindowFlags inset_flags = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                         ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_AlwaysAutoResize |
                                         ImGuiWindowFlags_NoFocusOnAppearing;

// Draws insets in the upper right corner, one below the other. `below` is where this one begins, and then where it
// ends.
void draw_inset(const char* name, const char* title, ImTextureID texture, const ImVec2& size, bool flipped,
                const Layout& layout, float& below, float margin) {
  ImGui::SetNextWindowPos(ImVec2(layout.view.high.x - margin, below), ImGuiCond_Always, ImVec2(1.0F, 0.0F));
  ImGui::SetNextWindowBgAlpha(0.85F);
  ImGui::Begin(name, nullptr, inset_flags);
  ImGui::TextUnformatted(title);
  const ImVec2 low = flipped ? ImVec2(0.0F, 1.0F) : ImVec2(0.0F, 0.0F);
  const ImVec2 high = flipped ? ImVec2(1.0F, 0.0F) : ImVec2(1.0F, 1.0F);
  ImGui::Image(texture, size, low, high);
  below += ImGui::GetWindowHeight() + margin;
  ImGui::End();
}

// Draws a line at the top of a picture, or several where that is narrow. Returns the height that they take.
float draw_tag(const char* name, const Area& picture, const std::string& text, float margin) {
  ImGui::SetNextWindowPos(ImVec2((picture.low.x + picture.high.x) / 2.0F, picture.low.y + margin), ImGuiCond_Always,
                          ImVec2(0.5F, 0.0F));
  ImGui::SetNextWindowBgAlpha(0.85F);
  ImGui::Begin(name, nullptr, inset_flags | ImGuiWindowFlags_NoInputs);
  ImGui::PushTextWrapPos(std::max(picture.width() - 4.0F * ImGui::GetFontSize(), 1.0F));
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
  const float height = ImGui::GetWindowHeight();
  ImGui::End();
  return height;
}

std::string count_text(const RefinedSide& side, const char* occlusion) {
  const auto triangles = static_cast<double>(side.refinement.stats.triangles);
  const auto visible = static_cast<double>(side.visible_triangles.value_or(0));
  return fmt::format("{}: {} of {} visible, {:.1f} %", occlusion, grouped(visible), grouped(triangles),
                     100.0 * visible / std::max(triangles, 1.0));
}

// Describes what stands beside a refinement.
std::string beside_text(const RefinedFrame& frame) {
  const RefinedSide& side = frame.sides[1];
  if (side.difference)
    return fmt::format("off the full mesh: RMS {:.2f} px, silhouette {:.2f} %", side.difference->rms_px,
                       side.difference->silhouette_mismatch);
  if (frame.job.beside == Beside::full)
    return fmt::format("full: {} triangles", grouped(static_cast<double>(side.refinement.stats.triangles)));
  return count_text(side, "no occlusion");
}

// Formats "coh: 341 nodes, 456,789 triangles, 12.3 ms".
std::string count_text(const HlodSide& side) {
  const hlod::Frame& frame = side.front->frame;
  const std::string& name = tool::name_of(side.strategy);
  const std::string by = frame.strategy == side.strategy ? name : name + " (" + tool::name_of(frame.strategy) + ")";
  return fmt::format(
      "{}: {} nodes, {} triangles at {:.3g} px, {:.2f} ms", by, grouped(static_cast<double>(frame.stats.drawn_nodes)),
      grouped(static_cast<double>(frame.stats.drawn_triangles)), side.tolerance_px, frame.times.frame_ms);
}

// Tells that the camera is recorded. Returns the height that this takes.
float draw_recording(const Session& session, const Layout& layout, float margin) {
  const Recording& recording = session.state().recording;
  if (recording.path.empty()) return 0.0F;
  ImGui::PushStyleColor(ImGuiCol_Text, error_color_of_text());
  const float height =
      draw_tag("recording", layout.view,
               fmt::format("Recording {}: {} keys; R stops", recording.path, recording.keys.keys.size()), margin);
  ImGui::PopStyleColor();
  return height;
}

// Tells of a tolerance that was raised. Returns the height that this takes.
float draw_limit(const Session& session, const Layout& layout, float margin) {
  const HlodSettings& hlod = session.state().settings.hlod;
  const auto& frame = session.frame();
  if (!frame || frame->hlod_sides.size() != 1) return 0.0F;
  const double used = frame->hlod_sides[0].tolerance_px;
  if (used <= hlod.traverse.tolerance_px || hlod.most_triangles == 0) return 0.0F;
  return draw_tag("limit", layout.view,
                  fmt::format("Drawn at {:.3g} px instead of {:.3g} px: {} triangles at most", used,
                              hlod.traverse.tolerance_px, grouped(static_cast<double>(hlod.most_triangles))),
                  margin);
}

void draw_tags(const Session& session, const Layout& layout, float margin) {
  const Settings& settings = session.state().settings;
  const float gap = margin;
  for (const auto& draw : {draw_recording, draw_limit})
    if (const float height = draw(session, layout, margin); height > 0.0F) margin += height + gap;
  if (settings.compare && layout.pictures.size() == 2 && session.frame() && session.frame()->sides.size() == 2) {
    const std::string name = "occlusion " + find_setting("occlusion")->get(settings).get<std::string>();
    const bool walks = session.frame()->cells != nullptr;
    draw_tag("left", layout.pictures[0], count_text(session.frame()->sides[0], walks ? "cell" : name.c_str()), margin);
    draw_tag("right", layout.pictures[1],
             walks ? count_text(session.frame()->sides[1], name.c_str()) : beside_text(*session.frame()), margin);
  } else if (settings.compare && layout.pictures.size() == 2 && session.frame() &&
             session.frame()->hlod_sides.size() == 2) {
    draw_tag("left", layout.pictures[0], count_text(session.frame()->hlod_sides[0]), margin);
    draw_tag("right", layout.pictures[1], count_text(session.frame()->hlod_sides[1]), margin);
  } else if (settings.freeze) {
    const bool walks = session.frame() && session.frame()->cells;
    draw_tag("frozen", layout.view, walks ? "The cell is frozen (Z)" : "Refinement is frozen (Z)", margin);
  }
}

}  // namespace

std::vector<LegendEntry> legend_of(const Session& session) {
  const Settings& settings = session.state().settings;
  const Objects& objects = *session.state().objects;
  if (!are_hlods(objects)) {
    int levels = 0;
    for (const PlacedObject& object : objects) levels = std::max(levels, object.mesh->level_count);
    const auto& frame = session.frame();
    if (!frame || !frame->cells) {
      std::vector<LegendEntry> entries = legend_of(settings.look.color_by, levels);
      if (settings.compare && settings.beside == Beside::difference)
        for (const LegendEntry& entry : legend_of_difference()) entries.push_back(entry);
      return entries;
    }
    std::vector<LegendEntry> entries = legend_of(settings.cells.color_by, levels);
    for (const LegendEntry& entry : legend_of(*frame->cells->cells, settings.cells.boxes)) entries.push_back(entry);
    return entries;
  }
  std::size_t levels = 0;
  for (const PlacedObject& object : objects) levels = std::max(levels, object.hlod->hlod->level_count());
  std::vector<LegendEntry> entries = legend_of(settings.hlod.color_by, levels);
  for (const LegendEntry& entry : legend_of(settings.hlod.boxes)) entries.push_back(entry);
  return entries;
}

void draw_insets(Panels& panels, const Layout& layout) {
  const float margin = 10.0F * panels.scale;
  const Session& session = panels.session;
  draw_tags(session, layout, margin);
  const Settings& settings = session.state().settings;
  const float width = std::min(280.0F * panels.scale, layout.view.width() * 0.35F);
  float below = layout.view.low.y + margin;
  if (settings.insets.birdseye && panels.insets.birdseye != nullptr)
    draw_inset("birdseye", "From above", panels.insets.birdseye, ImVec2(width, width * 0.75F), true, layout, below,
               margin);
  if (settings.insets.occluder && panels.insets.occluder != nullptr) {
    const DepthTexture& depth = *panels.insets.occluder;
    const std::string title = fmt::format("Occluder, level {}: {} x {}", depth.level(), depth.width(), depth.height());
    const float height = width * static_cast<float>(depth.height()) / static_cast<float>(std::max(depth.width(), 1));
    draw_inset("occluder", title.c_str(),
               reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(depth.texture())),  // NOLINT: ImGui's way
               ImVec2(width, height), false, layout, below, margin);
  }
}

void draw_legend(Panels& panels, const Layout& layout) {
  const Settings& settings = panels.session.state().settings;
  const std::vector<LegendEntry> entries = legend_of(panels.session);
  if (!settings.window.legend || entries.empty()) return;
  const float margin = 10.0F * panels.scale;
  ImGui::SetNextWindowPos(ImVec2(layout.view.low.x + margin, layout.view.high.y - margin), ImGuiCond_Always,
                          ImVec2(0.0F, 1.0F));
  ImGui::SetNextWindowBgAlpha(0.85F);
  ImGui::Begin("legend", nullptr, inset_flags | ImGuiWindowFlags_NoInputs);
  const float side = ImGui::GetTextLineHeight();
  for (const LegendEntry& entry : entries) {
    const ImVec2 at = ImGui::GetCursorScreenPos();
    ImGui::GetWindowDrawList()->AddRectFilled(at, ImVec2(at.x + side, at.y + side),
                                              IM_COL32(entry.color.r, entry.color.g, entry.color.b, 255), 2.0F);
    ImGui::Dummy(ImVec2(side, side));
    ImGui::SameLine();
    ImGui::TextUnformatted(entry.text.c_str());
  }
  ImGui::End();
}

}  // namespace occlod::viewer
