// Which folders a tileset may replace.
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>

#include "base/atomic_folder.h"
#include "occlod/core/error.h"
#include "occlod/tiles/write_tileset.h"

namespace occlod::tiles {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& folder, std::string problem, std::string remedy) {
  throw Error({folder.string(), "", std::move(problem), std::move(remedy)});
}

// Whether write_tileset() has made it.
bool is_ours(const fs::path& tileset) {
  std::ifstream stream(tileset, std::ios::binary);
  const nlohmann::json json = nlohmann::json::parse(stream, nullptr, false);
  if (!json.is_object() || !json.contains("asset")) return false;
  const nlohmann::json& asset = json["asset"];
  if (!asset.is_object() || !asset.contains("extras") || !asset["extras"].is_object()) return false;
  const auto generator = asset["extras"].find("generator");
  return generator != asset["extras"].end() && generator->is_string() &&
         generator->get<std::string>().starts_with("occlod ");
}

bool is_part(const std::string& name) {
  if (name == "tileset.json" || name == "tiles" || name == "textures") return true;
  constexpr std::string_view before = "tileset-", after = ".json";
  if (name.size() <= before.size() + after.size() || !name.starts_with(before) || !name.ends_with(after)) return false;
  const std::string number = name.substr(before.size(), name.size() - before.size() - after.size());
  return number.find_first_not_of("0123456789") == std::string::npos;
}

}  // namespace

void check_tileset_output(const fs::path& folder, bool replace) {
  AtomicFolder::check(folder);
  std::error_code error;
  if (!fs::exists(folder, error)) return;
  std::string other;
  bool is_empty = true;
  for (fs::directory_iterator entry(folder, error); !error && entry != fs::directory_iterator();
       entry.increment(error)) {
    is_empty = false;
    const std::string name = entry->path().filename().string();
    if (!is_part(name)) other = other.empty() ? name : std::min(other, name);
  }
  if (error) fail(folder, fmt::format("cannot be read: {}", error.message()), "check its permissions");
  if (is_empty) return;
  if (!other.empty())
    fail(folder, fmt::format("holds {}, which is no part of a tileset of occlod", other), "choose a new folder");
  if (!is_ours(folder / "tileset.json"))
    fail(folder, "holds a tileset.json that occlod has not written, or none", "choose a new folder");
  if (!replace) fail(folder, "holds a tileset already", "choose a new folder, or replace it with --replace");
}

}  // namespace occlod::tiles
