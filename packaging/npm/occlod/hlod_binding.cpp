// What hlod.js calls: HLODs, whole or from afar, and what views select of them.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <glm/common.hpp>
#include <glm/gtc/type_precision.hpp>
#include <glm/vec4.hpp>
#include <optional>

#include "binding.h"
#include "hlod/store/remote_ohlod.h"
#include "occlod/node_store.h"
#include "occlod/select.h"

namespace occlod::web {
namespace {

// An .ohlod file and what is selected of it.
struct HlodState {
  HlodState(const char* name, std::uint64_t bytes) : remote(name, bytes) {}

  [[nodiscard]] const hlod::Hlod& hlod() const { return remote.file().hlod; }

  hlod::RemoteOhlod remote;
  hlod::PlacedHlod placed;
  std::optional<hlod::Selector> selector;  // once the file is open
  std::vector<std::uint32_t> selected;     // of the last selection: see occlod_selected()
};

// Linear light, which is what renderers calculate with: colours of vertices times those of materials.
void add_colors(const hlod::HlodView& view, const hlod::NodeMesh& mesh, std::vector<std::uint16_t>& out) {
  const auto linear = [](float srgb) {
    return srgb <= 0.04045F ? srgb / 12.92F : std::pow((srgb + 0.055F) / 1.055F, 2.4F);
  };
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    glm::vec4 color(1.0F);
    if (!mesh.colors.empty()) {
      const glm::vec4 srgb = glm::vec4(mesh.colors[v]) / 255.0F;
      color = {linear(srgb.r), linear(srgb.g), linear(srgb.b), srgb.a};
    }
    const std::size_t material = mesh.materials.empty() ? 0 : mesh.materials[v];
    if (material < view.materials.size()) color *= view.materials[material].base_color;
    for (int i = 0; i < 4; ++i)
      out.push_back(static_cast<std::uint16_t>(std::lround(std::clamp(color[i], 0.0F, 1.0F) * 65535.0F)));
  }
}

// An image that has come damaged is 0 throughout, as no image begins.
bool has_image(const hlod::NodeMesh& mesh) { return !mesh.image.empty() && mesh.image[0] != 0; }

// Of a node with an image: its indices, where triangles of each patch come first that show the image, and where the
// others begin in each patch.
std::vector<std::uint16_t> sorted_indices;
std::vector<std::uint32_t> image_ends;

void sort_by_image(const hlod::Hlod& hlod, hlod::NodeId n) {
  const hlod::NodeMesh mesh = hlod.mesh(n);
  const hlod::HlodView& view = hlod.data();
  const auto shows_it = [&](std::size_t i) {
    const std::size_t material = mesh.materials.empty() ? 0 : mesh.materials[mesh.indices[i]];
    return material < view.image_materials.size() && view.image_materials[material] != 0;
  };
  sorted_indices.resize(mesh.indices.size());
  image_ends.clear();
  std::size_t to = 0;
  for (const hlod::Patch& patch : hlod.patches(n))
    for (const bool is_shown : {true, false}) {
      for (std::size_t i = patch.first_index; i < patch.first_index + patch.index_count; i += 3)
        if (shows_it(i) == is_shown)
          for (std::size_t k = 0; k < 3; ++k) sorted_indices[to++] = mesh.indices[i + k];
      if (is_shown) image_ends.push_back(static_cast<std::uint32_t>(to));
    }
}

}  // namespace
}  // namespace occlod::web

using namespace occlod;
using namespace occlod::web;

extern "C" {

// Numbers of bytes are doubles, so that files may be larger than 4 GiB.
EMSCRIPTEN_KEEPALIVE HlodState* occlod_new_hlod(const char* name, double bytes) {
  return guarded([&] { return new HlodState(name, static_cast<std::uint64_t>(bytes)); });
}
EMSCRIPTEN_KEEPALIVE void occlod_free_hlod(HlodState* state) { delete state; }

EMSCRIPTEN_KEEPALIVE bool occlod_put(HlodState* state, double offset, const std::byte* bytes, std::size_t size) {
  return guarded([&] {
    state->remote.put(static_cast<std::uint64_t>(offset), {bytes, size});
    return true;
  });
}

// Returns begin and end of each range that is missing, as doubles; none when the file is open.
EMSCRIPTEN_KEEPALIVE const Bytes* occlod_open_hlod(HlodState* state, double memory, bool whole) {
  return guarded([&] {
    const hlod::CacheOptions cache{.budget_bytes = static_cast<std::size_t>(memory),
                                   .load = whole ? hlod::LoadMode::blocking : hlod::LoadMode::async};
    std::vector<double> ends;
    for (const hlod::ByteRange& range : state->remote.open(cache)) {
      ends.push_back(static_cast<double>(range.begin));
      ends.push_back(static_cast<double>(range.end));
    }
    if (ends.empty()) {
      state->placed = {.hlod = &state->hlod(),
                       .object_to_world = positions_to_world(glm::dmat4(1.0), state->hlod().data().origin)};
      state->selector.emplace(std::span(&state->placed, 1));
    }
    const auto bytes = std::as_bytes(std::span(ends));
    kept.resize(bytes.size());
    std::ranges::copy(bytes, reinterpret_cast<std::byte*>(kept.data()));
    return bytes_of<std::uint8_t>(kept);
  });
}

// numbers: triangles of the input, nodes, levels, box, origin, 1 where y is up, 1 where there are normals,
// colours, images of nodes.
EMSCRIPTEN_KEEPALIVE void occlod_hlod_facts(const HlodState* state) {
  const hlod::HlodView& view = state->hlod().data();
  numbers = {static_cast<double>(view.input_triangle_count), static_cast<double>(view.nodes.size()),
             static_cast<double>(view.levels.size())};
  tell_place(3, view.box, view.origin, view.up);
  numbers[13] = view.has_normals ? 1.0 : 0.0;
  numbers[14] = view.has_colors || view.has_materials || !view.materials.empty() ? 1.0 : 0.0;
  numbers[15] = view.node_images.empty() ? 0.0 : 1.0;
}

// Sets the limit of memory for meshes and their images, bytes, which was given to occlod_open_hlod().
EMSCRIPTEN_KEEPALIVE bool occlod_limit_hlod(HlodState* state, double memory) {
  return guarded([&] {
    state->hlod().store()->set_budget(static_cast<std::size_t>(memory));
    return true;
  });
}

// numbers: the transform of its coordinates.
EMSCRIPTEN_KEEPALIVE bool occlod_place_hlod(HlodState* state) {
  return guarded([&] {
    state->selector->set_transform(0, transform_of_numbers(state->hlod().data().origin));
    return true;
  });
}

// numbers: a camera in; triangles, tolerance, largest error, hidden and missing nodes out.
EMSCRIPTEN_KEEPALIVE bool occlod_select(HlodState* state, double tolerance_px, std::size_t budget, bool occlusion,
                                        bool geomorph, double slack_px, int prefetch_frames) {
  state->selected.clear();
  return guarded([&] {
    const hlod::Selection& selection = state->selector->select(view_of_numbers(), {.tolerance_px = tolerance_px,
                                                                                   .budget = budget,
                                                                                   .occlusion = occlusion,
                                                                                   .geomorph = geomorph,
                                                                                   .slack_px = slack_px,
                                                                                   .prefetch_frames = prefetch_frames});
    for (const hlod::SelectedNode& node : selection.nodes) {
      state->selected.push_back(node.node);
      state->selected.push_back(static_cast<std::uint32_t>(node.ranges.size()));
      for (const hlod::DrawRange& range : node.ranges) {
        state->selected.push_back(range.first_index);
        state->selected.push_back(range.index_count);
        state->selected.push_back(std::bit_cast<std::uint32_t>(range.morph));
      }
    }
    numbers = {static_cast<double>(selection.triangles), selection.tolerance_px, selection.largest_error_px,
               static_cast<double>(selection.hidden), static_cast<double>(selection.missing)};
    text = fmt::format("{:016x}", selection.front_hash);
    return true;
  });
}

// Of the last selection: Selection::front_hash as 16 hexadecimal digits, until another text is asked for.
EMSCRIPTEN_KEEPALIVE const char* occlod_front_hash() { return text.c_str(); }

// Of the last selection, for each node: its number, that of its ranges, and for each of them first index, number of
// indices, and the bits of the float DrawRange::morph.
EMSCRIPTEN_KEEPALIVE const Bytes* occlod_selected(const HlodState* state) {
  return bytes_of<std::uint32_t>(state->selected);
}

// What is 0: positions, 1: normals, 2: indices, 3: colours, four numbers of 16 bits each, linear light; 4: where
// vertices slide to, three floats relative to where they are and the place of their patch among those of the node; 5:
// the image, encoded, empty where there is none that is whole; 6: where vertices are in it, two shares of 65,535.
// Indices of a node with an image are sorted, see occlod_image_ends().
EMSCRIPTEN_KEEPALIVE const Bytes* occlod_node_mesh(const HlodState* state, hlod::NodeId node, int what) {
  return guarded([&]() -> const Bytes* {
    const hlod::Hlod& hlod = state->hlod();
    hlod.require(node);
    const hlod::NodeMesh mesh = hlod.mesh(node);
    if (what == 0) return bytes_of<glm::vec3>(mesh.positions);
    if (what == 1) return bytes_of<glm::vec3>(mesh.normals);
    if (what == 5) return bytes_of(has_image(mesh) ? mesh.image : std::span<const std::uint8_t>());
    if (what == 6) return bytes_of<glm::u16vec2>(mesh.image_coordinates);
    if (what == 2 && mesh.image.empty()) return bytes_of<std::uint16_t>(mesh.indices);
    if (what == 2) {
      sort_by_image(hlod, node);
      return bytes_of<std::uint16_t>(sorted_indices);
    }
    static std::vector<std::uint16_t> colors;
    static std::vector<glm::vec4> slides;
    if (what == 3) {
      colors.clear();
      add_colors(hlod.data(), mesh, colors);
      return bytes_of<std::uint16_t>(colors);
    }
    slides.assign(mesh.positions.size(), glm::vec4(0.0F));
    float place = 0.0F;
    for (const hlod::Patch& patch : hlod.patches(node)) {
      if (patch.parent != no_id) {
        hlod.require(patch.parent);
        const hlod::NodeMesh parent = hlod.mesh(patch.parent);
        for (const std::uint16_t v : mesh.indices.subspan(patch.first_index, patch.index_count))
          if (mesh.merged_into[v] != hlod::stays)
            slides[v] = {parent.positions[mesh.merged_into[v]] - mesh.positions[v], place};
      }
      ++place;
    }
    return bytes_of<glm::vec4>(slides);
  });
}

// First index of each patch of a node, in the order of patches.
EMSCRIPTEN_KEEPALIVE const Bytes* occlod_node_patches(const HlodState* state, hlod::NodeId node) {
  static std::vector<std::uint32_t> firsts;
  firsts.clear();
  for (const hlod::Patch& patch : state->hlod().patches(node)) firsts.push_back(patch.first_index);
  return bytes_of<std::uint32_t>(firsts);
}

// Where the triangles that do not show the image of the node begin in each patch of a node with an image.
EMSCRIPTEN_KEEPALIVE const Bytes* occlod_image_ends(const HlodState* state, hlod::NodeId node) {
  return guarded([&]() -> const Bytes* {
    const hlod::Hlod& hlod = state->hlod();
    hlod.require(node);
    image_ends.clear();
    if (!hlod.mesh(node).image.empty()) sort_by_image(hlod, node);
    return bytes_of<std::uint32_t>(image_ends);
  });
}

// numbers: what to fetch next: its id, begin and end in the file, 1 where it came damaged before. False: nothing.
EMSCRIPTEN_KEEPALIVE bool occlod_next_request(HlodState* state) {
  const auto request = state->remote.next();
  if (!request) return false;
  numbers = {static_cast<double>(request->id), static_cast<double>(request->range.begin),
             static_cast<double>(request->range.end), request->again ? 1.0 : 0.0};
  return true;
}
EMSCRIPTEN_KEEPALIVE bool occlod_arrive(HlodState* state, std::uint32_t id, const std::byte* bytes, std::size_t size) {
  return guarded([&] {
    state->remote.arrive(id, {bytes, size});
    return true;
  });
}
EMSCRIPTEN_KEEPALIVE void occlod_lose(HlodState* state, std::uint32_t id) { state->remote.lose(id); }
EMSCRIPTEN_KEEPALIVE void occlod_fail(HlodState* state, std::uint32_t id, const char* problem) {
  state->remote.fail(id, problem);
}
EMSCRIPTEN_KEEPALIVE const Bytes* occlod_cancelled(HlodState* state) {
  static std::vector<std::uint32_t> ids;
  ids = state->remote.take_cancelled();
  return bytes_of<std::uint32_t>(ids);
}

// Lines on nodes and images that have failed since the last call.
EMSCRIPTEN_KEEPALIVE const char* occlod_node_failures(HlodState* state) {
  text.clear();
  for (const std::string& line : state->hlod().store()->take_failures()) text += line + '\n';
  for (const std::string& line : state->remote.take_dropped_images()) text += line + '\n';
  return text.c_str();
}

// numbers: bytes and number of the meshes that are there, bytes of those that come, the limit of both; nodes that have
// failed, meshes that came and their bytes in the file, meshes that left.
EMSCRIPTEN_KEEPALIVE void occlod_store_stats(const HlodState* state) {
  const hlod::StoreStats s = state->hlod().store()->stats();
  numbers = {static_cast<double>(s.resident_bytes), static_cast<double>(s.resident_nodes),
             static_cast<double>(s.loading_bytes),  static_cast<double>(s.budget_bytes),
             static_cast<double>(s.failed),         static_cast<double>(s.loads),
             static_cast<double>(s.bytes_loaded),   static_cast<double>(s.evictions)};
}

}  // extern "C"
