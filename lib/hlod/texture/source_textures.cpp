#include "hlod/texture/source_textures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>
#include <tuple>
#include <utility>

#include "base/threads.h"
#include "hlod/tiles/tile_mesh.h"
#include "mesh/image_codec.h"
#include "mesh/image_files.h"
#include "mesh/materials.h"

namespace occlod::tiles {

float linear_of(std::uint8_t srgb) noexcept {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> values{};
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = static_cast<float>(srgb_to_linear(static_cast<double>(i) / 255.0));
    return values;
  }();
  return table[srgb];
}

std::uint8_t srgb_of(float linear) noexcept {
  // The steepest part of the curve changes by 0.2 of a value from one entry to the next.
  constexpr int steps = 16384;
  static const std::array<std::uint8_t, steps + 1> table = [] {
    std::array<std::uint8_t, steps + 1> values{};
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = static_cast<std::uint8_t>(std::lround(255.0 * linear_to_srgb(static_cast<double>(i) / steps)));
    return values;
  }();
  return table[static_cast<std::size_t>(std::lround(std::clamp(linear, 0.0F, 1.0F) * steps))];
}

void TexelMean::add(const glm::u8vec4& texel, float weight) noexcept {
  const glm::vec3 light = weight * glm::vec3(linear_of(texel.r), linear_of(texel.g), linear_of(texel.b));
  const float alpha = static_cast<float>(texel.a) / 255.0F;
  light_ += alpha * light;
  bare_ += light;
  alpha_ += alpha * weight;
  weight_ += weight;
}

glm::u8vec4 TexelMean::value() const noexcept {
  const glm::vec3 light = alpha_ > 0.0F ? light_ / alpha_ : bare_ / weight_;
  return {srgb_of(light.r), srgb_of(light.g), srgb_of(light.b),
          static_cast<std::uint8_t>(std::lround(255.0F * (alpha_ / weight_)))};
}

namespace {

constexpr double most_texels = 2.0;              // of an image's, that all tiles of level 0 may take of it
constexpr double farthest_coordinate = 65536.0;  // texture coordinates beyond have no bits for texels

// Returns the texel of a row of `size` that texel i of the continued row shows.
std::int64_t wrapped(std::int64_t i, std::int64_t size, TextureWrap wrap) {
  if (i >= 0 && i < size) return i;
  if (wrap == TextureWrap::clamp) return std::clamp<std::int64_t>(i, 0, size - 1);
  const std::int64_t period = wrap == TextureWrap::mirror ? 2 * size : size;
  const std::int64_t within = (i % period + period) % period;
  return within < size ? within : 2 * size - 1 - within;
}

// Returns the coordinates with v downwards.
glm::dvec2 from_top(const glm::vec2& coordinates, TextureOrigin origin) {
  const double v = coordinates.y;
  return {coordinates.x, origin == TextureOrigin::top_left ? v : 1.0 - v};
}

// Returns the size of an image and of all smaller ones of it, without their texels.
std::vector<ImageLevel> sizes_of(ImageSize size) {
  std::vector<ImageLevel> levels{{size.width, size.height, {}, {}}};
  while (levels.back().width > 1 || levels.back().height > 1)
    levels.push_back({(levels.back().width + 1) / 2, (levels.back().height + 1) / 2, {}, {}});
  return levels;
}

// Fills the next smaller size. Texels that nothing shows count where nothing is shown at all.
void halve(const ImageLevel& level, const ImageLevel& half, unsigned threads) {
  for_each_task(static_cast<std::size_t>(half.height), threads, [&](std::size_t row) {
    make_room();
    const auto y = static_cast<std::int64_t>(row);
    for (std::int64_t x = 0; x < half.width; ++x) {
      TexelMean shown, all;
      unsigned coverage = 0;
      for (std::int64_t j = 2 * y; j < std::min<std::int64_t>(2 * y + 2, level.height); ++j)
        for (std::int64_t i = 2 * x; i < std::min<std::int64_t>(2 * x + 2, level.width); ++i) {
          const std::size_t at = level.at(i, j);
          coverage += level.coverage[at];
          if (level.coverage[at] > 0) shown.add(level.pixels[at], level.coverage[at]);
          all.add(level.pixels[at], 1.0F);
        }
      half.pixels[half.at(x, y)] = shown.is_empty() ? all.value() : shown.value();
      half.coverage[half.at(x, y)] = static_cast<std::uint8_t>((coverage + 3) / 4);
    }
  });
}

}  // namespace

std::size_t SourceImage::at(const ImageLevel& level, std::int64_t x, std::int64_t y) const noexcept {
  return level.at(wrapped(x, level.width, wrap_s), wrapped(y, level.height, wrap_t));
}

// Gathers what level 0 shows of each image.
class SourceTextures::Planner {
 public:
  Planner(SourceTextures& result, const hlod::Hlod& hlod, const std::filesystem::path& folder, unsigned threads,
          const std::function<void()>& next)
      : result_(result), hlod_(hlod), view_(hlod.data()), folder_(folder), threads_(threads), next_(next) {}

  void run() {
    find_images();
    if (plans_.empty()) return;
    for_each_leaf([this](const hlod::NodeMesh& mesh) { measure(mesh); });
    decide();
    if (result_.images_.empty()) return;
    read_images();
    for_each_leaf([this](const hlod::NodeMesh& mesh) { cover(mesh); });
    for (std::uint32_t i = 0; i < result_.images_.size(); ++i) result_.fill_coarser(i, threads_);
  }

 private:
  // What is known of an image before it is decoded.
  struct Plan {
    TextureId texture = no_texture;  // one that holds or names it
    std::string name;
    ImageSize size;
    std::string reason;            // why it stays shared; empty: it does not
    double packed = 0.0;           // texels that all charts take
    std::uint32_t number = no_id;  // in images_
  };

  // Gives each material that may show a divided image the number of its plan.
  void find_images() {
    result_.origin_ = view_.texture_origin;
    result_.image_of_.assign(view_.materials.size(), no_id);
    if (!view_.has_texture_coordinates) return;
    std::map<std::tuple<std::string, TextureWrap, TextureWrap>, std::uint32_t> by_file;
    std::map<TextureId, std::uint32_t> by_texture;
    for (std::size_t m = 0; m < view_.materials.size(); ++m) {
      const Material& material = view_.materials[m];
      if (material.texture == no_texture) continue;
      const Texture& texture = view_.textures[material.texture];
      const auto next = static_cast<std::uint32_t>(plans_.size());
      const std::uint32_t plan =
          texture.bytes.empty()
              ? by_file.try_emplace({texture.file, texture.wrap_s, texture.wrap_t}, next).first->second
              : by_texture.try_emplace(material.texture, next).first->second;
      if (plan == next) add_plan(material.texture);
      if (plans_[plan].size.width == 0) continue;
      const auto textures = material.textures();
      if (std::count(textures.begin(), textures.end(), no_texture) + 1 < std::ssize(textures))
        plans_[plan].reason = "a material has further maps";
      result_.image_of_[m] = plan;
    }
  }

  void add_plan(TextureId texture) {
    Plan& plan = plans_.emplace_back();
    plan.texture = texture;
    plan.name = name_of_image(view_.textures, texture);
    const auto bytes = find_image(view_.textures[texture], folder_);
    if (!bytes) return;
    try {
      plan.size = size_of_image(*bytes, plan.name);
    } catch (const Error&) {
      result_.shared_.push_back({plan.name, "it cannot be decoded"});
    }
  }

  template <typename Visit>
  void for_each_leaf(const Visit& visit) {
    const hlod::Level& finest = view_.levels[0];
    for (hlod::NodeId n = finest.first_node; n < finest.first_node + finest.node_count; ++n) {
      next_();
      make_room();
      hlod_.require(n);
      visit(hlod_.mesh(n));
    }
  }

  [[nodiscard]] std::uint32_t image_of(const hlod::NodeMesh& mesh, std::uint32_t vertex) const {
    return result_.image_of(mesh.materials.empty() ? MaterialId{0} : mesh.materials[vertex]);
  }

  void measure(const hlod::NodeMesh& mesh) {
    const std::vector<Triangle> triangles = triangles_of(mesh);
    std::vector<glm::dvec2> texels(mesh.positions.size(), glm::dvec2(0.0));
    std::vector<std::uint32_t> images(mesh.positions.size());
    for (std::uint32_t v = 0; v < images.size(); ++v) {
      images[v] = image_of(mesh, v);
      if (images[v] == no_id) continue;
      Plan& plan = plans_[images[v]];
      const glm::dvec2 place = from_top(mesh.texture_coordinates[v], view_.texture_origin);
      if (std::abs(place.x) < farthest_coordinate && std::abs(place.y) < farthest_coordinate)
        texels[v] = place * glm::dvec2(plan.size.width, plan.size.height);
      else
        plan.reason = "it has texture coordinates beyond 65536";
    }
    for (const Chart& chart : find_charts({mesh.positions, texels, images, triangles})) {
      const glm::dvec2 size(chart.texel_counts() + std::int64_t{2 * gutter});
      plans_[chart.image].packed += size.x * size.y;
    }
  }

  // Decides which images are divided, and numbers them.
  void decide() {
    for (Plan& plan : plans_) {
      if (plan.packed == 0.0) continue;  // not there, or nothing shows it
      const double texels = static_cast<double>(plan.size.width) * plan.size.height;
      if (plan.reason.empty() && plan.packed > most_texels * texels)
        plan.reason = fmt::format("its parts would have {:.1f} times its texels", plan.packed / texels);
      if (!plan.reason.empty()) {
        result_.shared_.push_back({plan.name, plan.reason});
        continue;
      }
      plan.number = static_cast<std::uint32_t>(result_.images_.size());
      const Texture& texture = view_.textures[plan.texture];
      result_.images_.push_back({texture.wrap_s, texture.wrap_t, false, sizes_of(plan.size)});
    }
    for (std::uint32_t& image : result_.image_of_)
      if (image != no_id) image = plans_[image].number;
  }

  void read_images() {
    result_.make_space();
    for (const Plan& plan : plans_) {
      if (plan.number == no_id) continue;
      const auto bytes = find_image(view_.textures[plan.texture], folder_);
      const auto has_changed = [&] {
        throw Error({plan.name, "", "has changed or gone while it was read", "leave it alone meanwhile"});
      };
      if (!bytes) has_changed();
      const Texels texels = decode_texels(*bytes, plan.name);
      if (texels.width != plan.size.width || texels.height != plan.size.height) has_changed();
      result_.images_[plan.number].is_jpeg = image_type(*bytes) == "image/jpeg";
      result_.fill(plan.number, texels, threads_);
    }
  }

  void cover(const hlod::NodeMesh& mesh) {
    for (const Triangle& t : triangles_of(mesh))
      if (const std::uint32_t image = image_of(mesh, t.x); image != no_id)
        result_.cover(image, mesh.texture_coordinates[t.x], mesh.texture_coordinates[t.y],
                      mesh.texture_coordinates[t.z]);
  }

  SourceTextures& result_;
  const hlod::Hlod& hlod_;
  const hlod::HlodView& view_;
  const std::filesystem::path& folder_;
  unsigned threads_;
  const std::function<void()>& next_;
  std::vector<Plan> plans_;
};

SourceTextures::SourceTextures(const hlod::Hlod& hlod, const std::filesystem::path& image_folder, unsigned threads,
                               const std::function<void()>& next) {
  Planner(*this, hlod, image_folder, threads, next).run();
}

SourceTextures::SourceTextures(ImageSize image, std::span<const std::uint8_t> is_shown_by, TextureOrigin origin)
    : origin_(origin), images_{{TextureWrap::clamp, TextureWrap::clamp, false, sizes_of(image)}} {
  for (const std::uint8_t is_shown : is_shown_by) image_of_.push_back(is_shown != 0 ? 0 : no_id);
}

void SourceTextures::show(const Texels& texels, const TriangleMesh& mesh) {
  make_space();
  fill(0, texels, 1);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto at = [&](int k) { return mesh.texture_coordinates[mesh.triangles[t][k]]; };
    if (image_of(mesh.material_of(t)) == 0) cover(0, at(0), at(1), at(2));
  }
  fill_coarser(0, 1);
}

void SourceTextures::make_space() {
  std::size_t all = 0;
  for (const SourceImage& image : images_)
    for (const ImageLevel& level : image.levels) all += level.count();
  pixels_.resize(all);
  coverage_.resize(all);
  std::size_t first = 0;
  for (SourceImage& image : images_)
    for (ImageLevel& level : image.levels) {
      level.pixels = std::span(pixels_).subspan(first, level.count());
      level.coverage = std::span(coverage_).subspan(first, level.count());
      first += level.count();
    }
}

void SourceTextures::fill(std::uint32_t image, const Texels& texels, unsigned threads) {
  const ImageLevel& finest = images_[image].levels[0];
  for_each_range(finest.count(), threads, [&](std::size_t begin, std::size_t end) {
    make_room();
    std::ranges::copy(std::span(texels.pixels).subspan(begin, end - begin), finest.pixels.subspan(begin).begin());
    std::ranges::fill(finest.coverage.subspan(begin, end - begin), std::uint8_t{0});
  });
}

void SourceTextures::cover(std::uint32_t image, const glm::vec2& a, const glm::vec2& b, const glm::vec2& c) {
  const SourceImage& source = images_[image];
  const ImageLevel& level = source.levels[0];
  for_each_centered_row(texels(image, a), texels(image, b), texels(image, c),
                        [&](std::int64_t y, std::int64_t x0, std::int64_t x1) {
                          for (std::int64_t x = x0; x < x1; ++x) level.coverage[source.at(level, x, y)] = 255;
                        });
}

void SourceTextures::fill_coarser(std::uint32_t image, unsigned threads) {
  const std::vector<ImageLevel>& levels = images_[image].levels;
  for (std::size_t k = 1; k < levels.size(); ++k) halve(levels[k - 1], levels[k], threads);
}

glm::dvec2 SourceTextures::texels(std::uint32_t image, const glm::vec2& coordinates) const noexcept {
  const ImageLevel& finest = images_[image].levels[0];
  return from_top(coordinates, origin_) * glm::dvec2(finest.width, finest.height);
}

TextureFormat SourceTextures::usual_format() const noexcept {
  return std::ranges::all_of(images_, &SourceImage::is_jpeg) ? TextureFormat::jpeg : TextureFormat::png;
}

glm::dvec2 SourceTextures::place(const glm::vec2& coordinates) const noexcept { return from_top(coordinates, origin_); }

glm::vec2 SourceTextures::coordinates(const glm::dvec2& place) const noexcept {
  return {place.x, origin_ == TextureOrigin::top_left ? place.y : 1.0 - place.y};
}

}  // namespace occlod::tiles
