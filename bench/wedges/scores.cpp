#include "wedges/scores.h"

#include <xxhash.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>
#include <optional>

#include "measure/attribute_distance.h"
#include "measure/surface_distance.h"
#include "object_textures.h"
#include "occlod/bounds.h"
#include "occlod/compare.h"
#include "occlod/item_buffer.h"
#include "occlod/picture.h"
#include "occlod/view.h"

namespace occlod::bench {
namespace {

using tool::ObjectTextures;
using tool::TextureChoice;

constexpr std::array<glm::dvec3, 3> directions = {{{1.0, 0.5, 1.0}, {-1.0, 0.3, 0.6}, {0.2, -0.4, -1.0}}};

std::vector<View> views_of(const TriangleMesh& mesh, int size_px) {
  const Box box = bounding_box(mesh.positions);
  const glm::dvec3 center = 0.5 * (glm::dvec3(box.min) + glm::dvec3(box.max));
  const double radius = 0.5 * glm::distance(glm::dvec3(box.min), glm::dvec3(box.max));
  std::vector<View> views;
  for (const glm::dvec3& direction : directions) {
    Camera camera;
    camera.width = camera.height = size_px;
    const double distance = fitting_distance(camera, radius);
    camera.target = center;
    camera.eye = center + distance * glm::normalize(direction);
    camera.near = 0.01 * radius;
    camera.far = distance + 2.0 * radius;
    views.emplace_back(camera);
  }
  return views;
}

struct Picture {
  ItemBuffer items;
  Image image;
};

Picture draw(const TriangleMesh& mesh, const ObjectTexture& texture, const View& view) {
  const DrawObject object{mesh.positions, {}, mesh.wedge_triangles()};
  Picture picture;
  draw_items(picture.items, {&object, 1}, view);
  picture.image = shade(picture.items, {&object, 1}, view, {.wire = false, .textures = {&texture, 1}});
  return picture;
}

std::uint64_t hash_of(const TriangleMesh& mesh) {
  XXH64_hash_t hash = 0;
  const auto add = [&](const auto& values) {
    hash = XXH3_64bits_withSeed(values.data(), sizeof(values[0]) * values.size(), hash);
  };
  add(mesh.positions);
  add(mesh.texture_coordinates);
  add(mesh.wedge_triangles());
  return hash;
}

}  // namespace

struct WedgeScorer::State {
  // Pictures of the input under one texture.
  struct Look {
    Look(const TriangleMesh& input, const std::filesystem::path& folder, TextureChoice texture_choice,
         const std::vector<View>& views)
        : choice(texture_choice), textures(input, folder, choice, {}) {
      if (!textures.has_image()) return;
      for (const View& view : views) pictures.push_back(draw(input, textures.texture(), view));
    }
    TextureChoice choice;
    ObjectTextures textures;
    std::vector<Picture> pictures;  // empty: nothing to draw
  };

  State(const TriangleMesh& mesh, const std::string& image_folder, const ScoreOptions& score_options)
      : input(mesh),
        folder(image_folder),
        options(score_options),
        surface(mesh.positions, mesh.triangles),
        views(views_of(mesh, options.size_px)),
        checker(mesh, folder, TextureChoice::checker, views),
        image(mesh, folder, TextureChoice::automatic, views) {}

  // Of the mean square over all views.
  [[nodiscard]] std::optional<double> psnr(const TriangleMesh& mesh, const Look& look) const {
    if (look.pictures.empty() || mesh.texture_coordinates.empty()) return {};
    const ObjectTextures textures(mesh, folder, look.choice, {});
    double mean_square = 0.0;
    for (std::size_t i = 0; i < views.size(); ++i) {
      const Picture picture = draw(mesh, textures.texture(), views[i]);
      const Picture& full = look.pictures[i];
      const double psnr =
          compare_pictures(views[i], picture.items.depth, picture.image, full.items.depth, full.image).psnr_y;
      mean_square += std::pow(10.0, -psnr / 10.0) / static_cast<double>(views.size());
    }
    return -10.0 * std::log10(mean_square);
  }

  const TriangleMesh& input;
  std::filesystem::path folder;
  ScoreOptions options;
  measure::Surface surface;
  std::vector<View> views;
  Look checker;
  Look image;
};

WedgeScorer::WedgeScorer(const TriangleMesh& input, const std::string& folder, const ScoreOptions& options)
    : state_(std::make_unique<State>(input, folder, options)) {}

WedgeScorer::~WedgeScorer() = default;

void WedgeScorer::score(WedgeRow& row, const WedgeRun& run, bool with_pictures) const {
  const TriangleMesh& mesh = run.result;
  row.triangles = mesh.triangle_count();
  row.bytes_per_vertex = run.bytes_per_vertex;
  row.hash = hash_of(mesh);
  if (mesh.triangles.empty()) return;
  const double percent = 100.0 / state_->surface.diagonal();
  const measure::Surface surface(mesh.positions, mesh.triangles);
  const measure::SurfaceDistance distance =
      measure::surface_distance(state_->surface, surface, {.samples = state_->options.samples, .seed = 1});
  row.geometry_rms_pct = percent * distance.rms();
  row.geometry_max_pct = percent * distance.farther().max;
  const auto slip =
      measure::attribute_distance(state_->input, mesh, {.samples = state_->options.samples, .seed = 1}).texture;
  if (slip) {
    row.slip_rms_pct = percent * slip->rms;
    row.slip_max_pct = percent * slip->max;
    row.slip_lost_pct = 100.0 * static_cast<double>(slip->lost) / static_cast<double>(state_->options.samples);
  }
  if (!with_pictures) return;
  row.psnr_checker_db = state_->psnr(mesh, state_->checker);
  row.psnr_image_db = state_->psnr(mesh, state_->image);
}

}  // namespace occlod::bench
