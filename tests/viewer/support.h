// Sessions over generated scenes.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "occlod/node_store.h"
#include "session.h"

namespace occlod::viewer::test {

// Removed with what is in it.
class Folder {
 public:
  Folder();
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder();
  [[nodiscard]] std::filesystem::path path(const std::string& name) const { return folder_ / name; }
  // Writes a file and says where.
  [[nodiscard]] std::filesystem::path write(const std::string& name, const nlohmann::json& content) const;

 private:
  std::filesystem::path folder_;
};

// A planet of 8 * 4^level triangles in a scene with a camera near it, the bookmark "far" and the path "by" of 5 frames.
[[nodiscard]] nlohmann::json planet_scene(int level = 7);

// Writes city.ohlod: 36 blocks of houses in nodes of up to 64 triangles, with splits.
std::filesystem::path write_city(const Folder& folder);
// A scene of this mesh with a camera in a street of that city, the bookmark "above" and the path "by" of 5 frames.
[[nodiscard]] nlohmann::json city_scene(const std::string& mesh);

// Writes an HLOD of a square sheet of 64 x 64 squares, over the unit square but for its hills, in nodes of up to 256
// triangles. It shows an image of 256 x 256 texels whose red grows along x and green along y: nodes have images of
// their own, or name the model's.
std::filesystem::path write_sheet(const Folder& folder, const std::string& name, OhlodImages images);

// A scene of a smaller city with the same street, cameras and path, and cells along the street that are built for the
// objects of a session that has opened it: their file.
[[nodiscard]] nlohmann::json street_scene();
std::filesystem::path write_street_cells(const Folder& folder, const Objects& objects);

// The software backend and none, no OpenGL.
[[nodiscard]] std::unique_ptr<Visibility> make_portable_visibility(Occlusion occlusion);

// Draws pictures, as far as a session knows, until it has settled. Fails after a minute.
void settle(Session& session);

// Performs {"do": ...} and settles. Throws Error.
void act(Session& session, const nlohmann::json& action);

}  // namespace occlod::viewer::test
