#include "settings_file.h"

#include "base/atomic_file.h"
#include "scene/find_mesh.h"
#include "setting_table.h"

namespace occlod::viewer {

std::filesystem::path default_settings_file() {
  const std::filesystem::path folder = user_config_folder();
  return folder.empty() ? folder : folder / "view.json";
}

bool read_settings(const std::filesystem::path& file, Session& session, RememberedWindow& window) {
  if (!std::filesystem::exists(file)) return false;
  const nlohmann::json document = parse_json_file(file);
  const std::string name = file.string();
  const JsonPlace root(document, name);
  if (!root.has("settings")) root.fail("is no settings file: it has no \"settings\"", "name another file");
  for (const auto& [key, place] : root.at("settings").members())
    if (const Setting* setting = find_setting(key); setting != nullptr && setting->kept)
      assign(*setting, session.state().settings, place);
  if (const auto recent = root.find("recent"))
    for (const JsonPlace& path : recent->elements(0)) session.state().recent.emplace_back(path.string());
  if (const auto place = root.find("window")) {
    const ImageSize size{place->at("width").integer(1), place->at("height").integer(1)};
    if (!is_window_size(size)) place->fail("is no size of a window", "remove it");
    window.size = size;
  }
  session.setting_changed();
  return true;
}

void write_settings(const std::filesystem::path& file, const State& state, const RememberedWindow& window) {
  nlohmann::ordered_json document;
  for (const Setting* setting : all_settings())
    if (setting->kept) document["settings"][setting->name] = setting->get(state.settings);
  document["recent"] = nlohmann::json::array();
  for (const std::filesystem::path& path : state.recent) document["recent"].push_back(path.string());
  document["window"] = {{"width", window.size.width}, {"height", window.size.height}};
  std::filesystem::create_directories(file.parent_path());
  AtomicFile target(file);
  target.stream() << document.dump(1) << '\n';
  target.commit();
}

}  // namespace occlod::viewer
