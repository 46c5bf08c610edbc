#include "chosen_views.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <map>
#include <vector>

#include "occlod/base.h"
#include "option_values.h"

namespace occlod::tool {
namespace {

constexpr std::uint64_t max_pixels = 16'384;  // along each side of an image

// Returns the camera or path of this name in a scene.
template <typename Named>
const Named& find_named(const std::map<std::string, Named>& all, const std::string& name, const char* place,
                        const SceneDescription& scene) {
  const auto found = all.find(name);
  if (found != all.end()) return found->second;
  std::vector<std::string> names;
  for (const auto& [other, ignored] : all) names.push_back(other);
  throw Error({scene.file.string(), place, fmt::format("has no \"{}\"", name),
               names.empty() ? "add it" : fmt::format("use one of: {}", fmt::join(names, ", "))});
}

void change(Camera& camera, const ViewOptions& options) {
  if (options.size) {
    camera.width = options.size->width;
    camera.height = options.size->height;
  }
  if (options.orthographic && !camera.orthographic_height) camera = orthographic(camera);
}

}  // namespace

bool is_compared(int frame, int compared, int frames) {
  if (frame >= frames) return false;
  const auto so_far = [&](std::int64_t drawn) { return drawn * std::min(compared, frames) / frames; };
  return so_far(frame + std::int64_t{1}) > so_far(frame);
}

std::optional<ImageSize> parse_size(const std::string& text) {
  const std::size_t x = std::min(text.find('x'), text.size());
  const auto width = whole_number(text.substr(0, x));
  const auto height = whole_number(text.substr(std::min(x + 1, text.size())));
  if (!width || !height || *width < 1 || *height < 1 || *width > max_pixels || *height > max_pixels) return {};
  return ImageSize{static_cast<int>(*width), static_cast<int>(*height)};
}

void add_size_option(CLI::App& command, ViewOptions& options) {
  const auto set_size = [&options](const std::string& text) {
    options.size = parse_size(text);
    if (!options.size)
      throw CLI::ValidationError("--size", fmt::format("{} is not WIDTHxHEIGHT from 1x1 to {}x{} pixels", shown(text),
                                                       max_pixels, max_pixels));
  };
  command
      .add_option_function<std::string>("--size", set_size, "Size of the image in pixels instead of the camera's own")
      ->type_name("WxH");
}

void add_size_options(CLI::App& command, ViewOptions& options) {
  add_size_option(command, options);
  command.add_flag("--orthographic", options.orthographic,
                   "Parallel projection that shows as much at the distance of the camera's target");
}

Camera chosen_camera(const SceneDescription& scene, const ViewOptions& options) {
  Camera camera = find_named(scene.cameras, options.camera, "/cameras", scene);
  change(camera, options);
  return camera;
}

CameraPath chosen_path(const SceneDescription& scene, const ViewOptions& options) {
  CameraPath path = find_named(scene.paths, options.path, "/paths", scene);
  for (Camera& key : path.keys) change(key, options);
  return path;
}

Camera camera_that_sees(const WorldBox& box, const ViewOptions& options) {
  Camera camera;
  if (options.size) {
    camera.width = options.size->width;
    camera.height = options.size->height;
  }
  camera = looking_at(box.center(), box.radius(), camera);
  change(camera, options);
  return camera;
}

}  // namespace occlod::tool
