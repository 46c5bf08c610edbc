#include "hlod_side.h"

#include <algorithm>

#include "front_mesh.h"
#include "hlod/texture/image_place.h"
#include "occlod/build_hlod.h"
#include "occlod/hlod.h"
#include "palette.h"

namespace occlod::viewer {
namespace {

template <class T>
void append(std::vector<T>& to, std::span<const T> more) {
  to.insert(to.end(), more.begin(), more.end());
}

// Appends the attributes that DrawObject lacks.
void append_attributes(FrontObject& to, const hlod::DrawnNode& draw, const hlod::Hlod& hlod) {
  const auto append_all = [&](const auto& from) {
    append(to.normals, from.normals);
    append(to.texture_coordinates, from.texture_coordinates);
    append(to.materials, from.materials);
  };
  append_all(hlod.mesh(draw.node));
  if (draw.splits > 0) append_all(hlod.within(draw.node));
}

// Appends where the vertices are in the node's own image, once all else of them is appended. A cut shows no image.
void append_image_coordinates(FrontObject& to, const hlod::DrawnNode& draw, const hlod::Hlod& hlod) {
  const hlod::HlodView& view = hlod.data();
  if (view.node_images.empty()) return;
  const hlod::NodeMesh mesh = hlod.mesh(draw.node);
  const bool has_image = draw.splits == 0 && !mesh.image.empty();
  for (std::size_t v = 0; has_image && v < mesh.positions.size(); ++v)
    to.image_coordinates.push_back(hlod::image_place(view, mesh, v).value_or(glm::vec2(-1.0F)));
  to.image_coordinates.resize(to.positions.size(), glm::vec2(-1.0F));
}

// Ranges contain whole patches; both are ascending.
void append_patches(std::vector<std::uint32_t>& to, const hlod::DrawnNode& draw,
                    std::span<const hlod::DrawRange> ranges, const hlod::Hlod& hlod) {
  const std::uint32_t first = hlod.node(draw.node).first_patch;
  const std::span<const hlod::Patch> patches = hlod.patches(draw.node);
  for (const hlod::DrawRange& range : ranges)
    for (std::uint32_t p = 0; p < patches.size(); ++p)
      if (patches[p].first_index >= range.first_index && patches[p].first_index < range.first_index + range.index_count)
        to.insert(to.end(), patches[p].index_count / 3, first + p);
}

void append_draw(FrontObject& to, const DrawObject& mesh, const hlod::DrawnNode& draw,
                 std::span<const hlod::DrawRange> ranges, const hlod::Hlod& hlod) {
  const auto first = static_cast<std::uint32_t>(to.positions.size());
  append(to.positions, mesh.positions);
  append_attributes(to, draw, hlod);
  append_image_coordinates(to, draw, hlod);
  append(to.colors, mesh.colors);
  for (const Triangle& t : mesh.triangles) to.triangles.push_back(t + first);
  append_patches(to.patches, draw, ranges, hlod);
  to.patches.resize(to.triangles.size(), no_id);
}

glm::u8vec4 color_of_draw(const hlod::DrawnNode& draw, const PlacedObject& object, const View& view,
                          const HlodSettings& settings) {
  const hlod::Hlod& hlod = *object.hlod->hlod;
  switch (settings.color_by) {
    case HlodColorBy::level:
      return hlod_level_color(hlod.node(draw.node).level, hlod.level_count());
    case HlodColorBy::error:
      return error_color(error_px(draw, object, view));
    case HlodColorBy::bias:
      return bias_color(draw.bias);
    case HlodColorBy::state:
      return color_of(drawn_as(draw));
    case HlodColorBy::plain:
    case HlodColorBy::vertices:
    case HlodColorBy::texture:
    case HlodColorBy::patch:
      break;
  }
  return {};
}

}  // namespace

std::shared_ptr<const HlodFront> make_front(const hlod::Frame& frame, const Objects& objects, std::uint64_t number) {
  auto result = std::make_shared<HlodFront>();
  result->number = number;
  result->frame = frame;
  const tool::Front front = tool::front_of(frame);
  result->frame.draws = front.draws;
  const std::vector<hlod::PlacedHlod> placed = placed_hlods(objects);
  tool::FrontMesh mesh;
  mesh.assign(front, placed);
  result->objects.resize(objects.size());
  for (std::size_t i = 0; i < front.draws.size(); ++i) {
    const hlod::DrawnNode& draw = front.draws[i];
    FrontObject& object = result->objects[draw.object];
    result->first_triangle.push_back(object.triangles.size());
    append_draw(object, mesh.objects()[i], draw, std::span(front.ranges).subspan(draw.first_range, draw.range_count),
                *placed[draw.object].hlod);
  }
  return result;
}

std::size_t draw_of(const HlodFront& front, std::size_t object, std::size_t triangle) {
  std::size_t found = 0;
  for (std::size_t i = 0; i < front.frame.draws.size(); ++i)
    if (front.frame.draws[i].object == object && front.first_triangle[i] <= triangle) found = i;
  return found;
}

double error_px(const hlod::DrawnNode& draw, const PlacedObject& object, const View& view) {
  const hlod::Hlod& hlod = *object.hlod->hlod;
  const hlod::Node& node = hlod.node(draw.node);
  const hlod::ScreenScale scale = hlod::screen_scale(view, ObjectView(view, object.object_to_world));
  if (draw.splits == 0) return screen_error_px(node, scale);
  const double a_pixel = screen_error_limit(node, scale, 1.0);
  return std::max(error_of_splits(hlod, draw.node, draw.splits) / a_pixel, min_screen_error_px(node, scale));
}

std::vector<std::vector<glm::u8vec4>> colors_of(const HlodFront& front, const Objects& objects, const View& view,
                                                const HlodSettings& settings) {
  std::vector<std::vector<glm::u8vec4>> colors(objects.size());
  if (settings.color_by == HlodColorBy::plain || settings.color_by == HlodColorBy::vertices ||
      settings.color_by == HlodColorBy::texture)
    return colors;
  const std::vector<hlod::DrawnNode>& draws = front.frame.draws;
  for (std::size_t o = 0; o < objects.size(); ++o) {
    const FrontObject& object = front.objects[o];
    colors[o].reserve(object.triangles.size());
    if (settings.color_by == HlodColorBy::patch) {
      for (const std::uint32_t patch : object.patches) colors[o].push_back(patch_color(patch));
      continue;
    }
    // This runs from the last draw to the first, each from its first triangle to where the next begins.
    colors[o].resize(object.triangles.size());
    std::size_t end = object.triangles.size();
    for (std::size_t i = draws.size(); i-- > 0;) {
      if (draws[i].object != o) continue;
      const glm::u8vec4 color = color_of_draw(draws[i], objects[o], view, settings);
      std::fill(colors[o].begin() + static_cast<std::ptrdiff_t>(front.first_triangle[i]),
                colors[o].begin() + static_cast<std::ptrdiff_t>(end), color);
      end = front.first_triangle[i];
    }
  }
  return colors;
}

}  // namespace occlod::viewer
