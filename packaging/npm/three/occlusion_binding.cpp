// What occlusion.js calls: software occlusion for meshes that a page has loaded, without the rest of the library, so
// that a page loads little. Numbers pass through occlusion_numbers(); a call that fails returns 0 and
// occlusion_failure() says why.
#include <emscripten.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <glm/geometric.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "occlod/item_buffer.h"
#include "occlod/mesh.h"
#include "occlod/view.h"
#include "occlod/visibility.h"

namespace occlod::web {
namespace {

// Which sides of a mesh are drawn, as three.js counts them.
enum class Side : std::uint32_t { front, back, both };

struct OccluderMesh {
  std::vector<glm::vec3> positions;
  std::vector<Triangle> triangles;
  Side side = Side::both;
};

// What one camera sees. The object of its views is the world, in which bounds are asked.
struct Sight {
  std::unique_ptr<SoftwareOcclusion> software = make_software_occlusion();
  DepthBuffer depth;
};

std::vector<Triangle> shown;  // of one occluder
std::vector<float> rows;      // of one depth image

std::string failure;
std::vector<double> numbers;
constexpr std::size_t camera_numbers = 35, part_numbers = 17;

View view_of_numbers() {
  const double* n = numbers.data();
  return view_of(glm::make_mat4(n), glm::make_mat4(n + 16), static_cast<int>(n[32]), static_cast<int>(n[33]),
                 static_cast<ClipDepth>(static_cast<int>(n[34])));
}

// Returns the triangles of which the eye surely sees a side that is drawn. A triangle that is left out hides nothing,
// so rounding is on the safe side.
std::span<const Triangle> find_shown(const OccluderMesh& mesh, const glm::vec3& eye) {
  if (mesh.side == Side::both) return mesh.triangles;
  const float sign = mesh.side == Side::front ? 1.0F : -1.0F;
  std::size_t count = 0;
  shown.resize(mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) {
    const glm::vec3 &a = mesh.positions[t.x], &b = mesh.positions[t.y], &c = mesh.positions[t.z];
    shown[count] = t;
    count += sign * glm::dot(glm::cross(b - a, c - a), eye - a) > 0.0F ? 1 : 0;
  }
  return std::span(shown).first(count);
}

// Gives each pixel the farthest depth of 3x3 pixels: a GPU rounds corners otherwise and may take several samples, so
// near an outline it may show what is behind. O(pixels).
void widen_gaps(DepthBuffer& depth) {
  const auto width = static_cast<std::size_t>(depth.width), height = static_cast<std::size_t>(depth.height);
  rows.resize(depth.nearness.size());
  for (std::size_t y = 0; y < height; ++y) {
    const float* from = depth.nearness.data() + y * width;
    float* to = rows.data() + y * width;
    to[0] = from[0];
    to[width - 1] = from[width - 1];
    for (std::size_t x = 1; x + 1 < width; ++x) to[x] = std::min(std::min(from[x - 1], from[x]), from[x + 1]);
  }
  for (std::size_t y = 0; y < height; ++y) {
    const float* above = rows.data() + (y == 0 ? y : y - 1) * width;
    const float* here = rows.data() + y * width;
    const float* below = rows.data() + (y + 1 == height ? y : y + 1) * width;
    float* to = depth.nearness.data() + y * width;
    for (std::size_t x = 0; x < width; ++x) to[x] = std::min(std::min(above[x], here[x]), below[x]);
  }
}

// Draws the occluders of a view; numbers: of the camera, then of each occluder its mesh and its transform. Returns how
// many triangles were drawn.
std::size_t draw(Sight& sight, std::size_t count) {
  const View view = view_of_numbers();
  sight.depth.reset(view.width(), view.height());
  std::size_t drawn = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double* n = numbers.data() + camera_numbers + i * part_numbers;
    const auto& mesh = *reinterpret_cast<const OccluderMesh*>(static_cast<std::uintptr_t>(n[0]));
    const ObjectView object(view, glm::make_mat4(n + 1));
    const auto triangles = find_shown(mesh, object.eye());
    draw_depth(sight.depth, mesh.positions, triangles, object.object_to_clip());
    drawn += triangles.size();
  }
  widen_gaps(sight.depth);
  const ObjectView world(view, glm::dmat4(1.0));
  sight.software->show(sight.depth, view, std::span(&world, 1));
  sight.software->begin_view(view, std::span(&world, 1));
  return drawn;
}

bool is_visible(Sight& sight, const VisibilityQuery& query) {
  sight.software->submit(query);
  return sight.software->collect() != 0;
}

}  // namespace
}  // namespace occlod::web

using namespace occlod;
using namespace occlod::web;

extern "C" {

EMSCRIPTEN_KEEPALIVE const char* occlusion_failure() { return failure.c_str(); }

// Returns room for as many numbers; it stays there until the next call.
EMSCRIPTEN_KEEPALIVE double* occlusion_numbers(std::size_t count) {
  if (numbers.size() < count) numbers.resize(count);
  return numbers.data();
}

EMSCRIPTEN_KEEPALIVE OccluderMesh* occlusion_add_mesh(const glm::vec3* positions, std::size_t vertices,
                                                      const Triangle* triangles, std::size_t count, Side side) {
  try {
    auto mesh = std::make_unique<OccluderMesh>();
    mesh->positions.assign(positions, positions + vertices);
    mesh->side = side;
    for (const Triangle& t : std::span(triangles, count))
      if (t.x < vertices && t.y < vertices && t.z < vertices) mesh->triangles.push_back(t);
    return mesh.release();
  } catch (const std::exception& error) {
    failure = error.what();
    return nullptr;
  }
}
EMSCRIPTEN_KEEPALIVE void occlusion_free_mesh(OccluderMesh* mesh) { delete mesh; }

EMSCRIPTEN_KEEPALIVE Sight* occlusion_new() { return new Sight; }
EMSCRIPTEN_KEEPALIVE void occlusion_free(Sight* sight) { delete sight; }

// Returns the number of triangles drawn and 1 more, or 0 after a failure.
EMSCRIPTEN_KEEPALIVE std::size_t occlusion_draw(Sight* sight, std::size_t parts) {
  try {
    return draw(*sight, parts) + 1;
  } catch (const std::exception& error) {
    failure = error.what();
    return 0;
  }
}

// numbers: the points, of which there are at most 8, in the world.
EMSCRIPTEN_KEEPALIVE bool occlusion_shows_hull(Sight* sight, std::size_t points) {
  std::array<glm::vec3, 8> hull;
  for (std::size_t i = 0; i < points; ++i) hull[i] = glm::vec3(glm::make_vec3(numbers.data() + 3 * i));
  return is_visible(*sight, {0, PointHull{std::span(hull).first(points)}});
}

// numbers: centre and radius, in the world.
EMSCRIPTEN_KEEPALIVE bool occlusion_shows_sphere(Sight* sight) {
  const glm::vec3 center(glm::make_vec3(numbers.data()));
  return is_visible(*sight, {0, Sphere{center, static_cast<float>(numbers[3])}});
}

}  // extern "C"
