// What index.js calls: meshes, hierarchies and their refinement.
#include "binding.h"

#include <fmt/format.h>
#include <zstd.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "mesh/image_files.h"
#include "occlod/build_hierarchy.h"
#include "occlod/item_buffer.h"
#include "occlod/mesh_file.h"
#include "occlod/refiner.h"
#include "occlod/simplify.h"

// Tells JavaScript the share that is done; false cancels.
EM_JS(bool, report_progress, (double done), { return Module.occlodProgress(done); });

namespace occlod::web {
namespace {

struct StoredHierarchy {
  Hierarchy hierarchy;
  MeshReport report;  // on the mesh, for .olod files
};

// Refines with or without occlusion. The hierarchies stay for as long as it does.
struct RefinerState {
  std::vector<Hierarchy> hierarchies;
  std::vector<RefineObject> objects;
  std::optional<Refiner> refiner;
  std::unique_ptr<Visibility> software = make_software_occlusion();
  NoOcclusion none;
  const Refinement* last = nullptr;
};

ItemBuffer items;  // of occlod_seen()

// Meshes are read from and written to a folder in memory, which is empty between calls.
const std::filesystem::path& folder() {
  static const std::filesystem::path path = "/occlod";
  std::filesystem::create_directory(path);
  return path;
}

// While it lives, the folder is the current one, so that errors name files as they were given. Then it is emptied.
class InFolder {
 public:
  InFolder() { std::filesystem::current_path(folder()); }
  ~InFolder() {
    std::error_code ignored;
    std::filesystem::current_path("/", ignored);
    std::filesystem::remove_all(folder(), ignored);
  }
  InFolder(const InFolder&) = delete;
  InFolder& operator=(const InFolder&) = delete;
};

const Bytes* content_of(const std::filesystem::path& file) {
  kept.resize(std::filesystem::file_size(file));
  std::ifstream(file, std::ios::binary)
      .read(reinterpret_cast<char*>(kept.data()), static_cast<std::streamsize>(kept.size()));
  return bytes_of<std::uint8_t>(kept);
}

// Files beside the mesh are gone after the call, so the mesh takes the images.
void embed_images(TriangleMesh& mesh) {
  for (Texture& texture : mesh.textures) {
    auto image = texture.bytes.empty() ? read_image(texture, ".") : std::nullopt;
    if (!image) continue;
    texture.mime_type = image_type(*image, texture.file);
    texture.bytes.assign(image->begin(), image->end());
    texture.file.clear();
  }
}

bool faces_eye(const Triangle& t, std::span<const glm::vec3> positions, const glm::vec3& eye) {
  const glm::vec3 &a = positions[t.x], &b = positions[t.y], &c = positions[t.z];
  return glm::dot(glm::cross(b - a, c - a), eye - a) > 0.0F;
}

bool outside_a_plane(const Triangle& t, std::span<const glm::vec3> positions, const ObjectView& view) {
  return std::ranges::any_of(view.planes(), [&](const glm::vec4& plane) {
    const auto outside = [&](VertexId v) { return glm::dot(glm::vec3(plane), positions[v]) + plane.w < 0.0F; };
    return outside(t.x) && outside(t.y) && outside(t.z);
  });
}

}  // namespace
}  // namespace occlod::web

using namespace occlod;
using namespace occlod::web;

extern "C" {

// Puts a file where occlod_read_mesh() looks for it. The name has no folders.
EMSCRIPTEN_KEEPALIVE bool occlod_add_file(const char* name, const char* bytes, std::size_t size) {
  return guarded([&] {
    std::ofstream file(folder() / name, std::ios::binary);
    file.write(bytes, static_cast<std::streamsize>(size));
    file.close();
    if (!file) throw std::bad_alloc();
    return true;
  });
}

// Reads a mesh from a file that has been added, and forgets all that have been.
EMSCRIPTEN_KEEPALIVE CleanMesh* occlod_read_mesh(const char* name) {
  return guarded([&] {
    const InFolder inside;
    const auto progress = [&](double done) {
      if (!report_progress(done)) throw Error({name, "", "reading was cancelled", ""});
    };
    auto mesh = std::make_unique<CleanMesh>(read_mesh(name, progress, 1));
    embed_images(mesh->mesh);
    return mesh.release();
  });
}

// Makes a mesh of 3 floats for each vertex and 3 ids for each triangle.
EMSCRIPTEN_KEEPALIVE CleanMesh* occlod_make_mesh(const glm::vec3* positions, std::size_t vertices,
                                                 const Triangle* triangles, std::size_t triangle_count) {
  return guarded([&] {
    TriangleMesh mesh;
    mesh.positions.assign(positions, positions + vertices);
    mesh.triangles.assign(triangles, triangles + triangle_count);
    return new CleanMesh(clean(std::move(mesh), {}, "mesh", 1));
  });
}

EMSCRIPTEN_KEEPALIVE void occlod_free_mesh(CleanMesh* mesh) { delete mesh; }
EMSCRIPTEN_KEEPALIVE std::size_t occlod_mesh_triangle_count(const CleanMesh* mesh) {
  return mesh->mesh.triangle_count();
}
EMSCRIPTEN_KEEPALIVE const Bytes* occlod_mesh_positions(const CleanMesh* mesh) {
  return bytes_of<glm::vec3>(mesh->mesh.positions);
}
EMSCRIPTEN_KEEPALIVE const Bytes* occlod_mesh_triangles(const CleanMesh* mesh) {
  return bytes_of<Triangle>(mesh->mesh.wedge_triangles());
}

// The extension of the name decides the format.
EMSCRIPTEN_KEEPALIVE const Bytes* occlod_write_mesh(const CleanMesh* mesh, const char* name) {
  return guarded([&] {
    const InFolder inside;
    write_mesh(name, mesh->mesh);
    return content_of(name);
  });
}

EMSCRIPTEN_KEEPALIVE CleanMesh* occlod_simplify(const CleanMesh* mesh, std::size_t triangles, double error) {
  return guarded([&] {
    const SimplifyOptions options{.threads = 1, .progress = report_progress};
    CleanMesh simpler;
    if (triangles > 0)
      simpler.mesh = simplify(mesh->mesh, triangles, options);
    else
      simpler.mesh = simplify_within(mesh->mesh, error, options).mesh;
    count_topology(simpler.mesh, simpler.report, 1);
    return new CleanMesh(std::move(simpler));
  });
}

EMSCRIPTEN_KEEPALIVE StoredHierarchy* occlod_build(const CleanMesh* mesh) {
  return guarded([&] {
    const BuildOptions options{.threads = 1, .progress = report_progress};
    return new StoredHierarchy{build_hierarchy(mesh->mesh, options), mesh->report};
  });
}

// Reads an .olod file that has been added, and forgets all that have been.
EMSCRIPTEN_KEEPALIVE StoredHierarchy* occlod_read_hierarchy(const char* name) {
  return guarded([&] {
    const InFolder inside;
    OlodFile file = read_olod(name, OlodAccess::copied);
    file.hierarchy.require_all();
    return new StoredHierarchy{std::move(file.hierarchy), std::move(file.report)};
  });
}

EMSCRIPTEN_KEEPALIVE void occlod_free_hierarchy(StoredHierarchy* hierarchy) { delete hierarchy; }

EMSCRIPTEN_KEEPALIVE const Bytes* occlod_write_hierarchy(const StoredHierarchy* stored, bool compressed) {
  return guarded([&] {
    const InFolder inside;
    const std::filesystem::path file = "hierarchy.olod";
    write_olod(file, stored->hierarchy, stored->report, compressed ? OlodCompression::zstd : OlodCompression::none);
    return content_of(file);
  });
}

EMSCRIPTEN_KEEPALIVE const Bytes* occlod_hierarchy_positions(const StoredHierarchy* stored) {
  return bytes_of<glm::vec3>(stored->hierarchy.positions());
}
EMSCRIPTEN_KEEPALIVE const Bytes* occlod_hierarchy_normals(const StoredHierarchy* stored) {
  return bytes_of<glm::vec3>(stored->hierarchy.data().normals);
}
EMSCRIPTEN_KEEPALIVE const Bytes* occlod_hierarchy_colors(const StoredHierarchy* stored) {
  return bytes_of<glm::u8vec4>(stored->hierarchy.data().colors);
}

// numbers: triangles of the input and of the base mesh, bound of errors, box, origin, 1 where y is up.
EMSCRIPTEN_KEEPALIVE void occlod_hierarchy_facts(const StoredHierarchy* stored) {
  const Hierarchy& h = stored->hierarchy;
  numbers = {static_cast<double>(h.input_triangle_count()), static_cast<double>(h.base_triangle_count()),
             h.error_bound()};
  tell_place(3, h.box(), h.data().origin, h.data().up);
}

EMSCRIPTEN_KEEPALIVE CleanMesh* occlod_cut(const StoredHierarchy* stored, std::size_t triangles, double error) {
  return guarded([&] {
    const Hierarchy& hierarchy = stored->hierarchy;
    if (!(error >= 0.0)) throw Error({"cut", "error", "is not a number of at least 0", "give object units"});
    const FixedCut cut = triangles > 0 ? cut_to_triangles(hierarchy, triangles) : cut_to_error(hierarchy, error);
    CleanMesh mesh;
    mesh.mesh = cut_mesh(hierarchy, cut);
    count_topology(mesh.mesh, mesh.report, 1);
    return new CleanMesh(std::move(mesh));
  });
}

// numbers, in and out: a camera, as looking_at() moves it to see the hierarchy at its coordinates.
EMSCRIPTEN_KEEPALIVE bool occlod_look_at(const StoredHierarchy* stored) {
  return guarded([&] {
    const Camera camera = looking_at(stored->hierarchy.box(), view_of_numbers().camera());
    const glm::dvec3& origin = stored->hierarchy.data().origin;
    const glm::dvec3 eye = camera.eye + origin, target = camera.target + origin;
    std::copy_n(glm::value_ptr(eye), 3, numbers.begin() + 1);
    std::copy_n(glm::value_ptr(target), 3, numbers.begin() + 4);
    numbers[13] = camera.near;
    numbers[14] = camera.far;
    return true;
  });
}

EMSCRIPTEN_KEEPALIVE RefinerState* occlod_new_refiner() { return new RefinerState; }
EMSCRIPTEN_KEEPALIVE void occlod_free_refiner(RefinerState* state) { delete state; }

// numbers: the transform of its coordinates.
EMSCRIPTEN_KEEPALIVE void occlod_add_object(RefinerState* state, const StoredHierarchy* stored, bool two_sided) {
  state->hierarchies.push_back(stored->hierarchy);
  state->objects.push_back(
      {.object_to_world = transform_of_numbers(stored->hierarchy.data().origin), .two_sided = two_sided});
}

// Takes the objects that have been added.
EMSCRIPTEN_KEEPALIVE bool occlod_start_refiner(RefinerState* state) {
  return guarded([&] {
    for (std::size_t i = 0; i < state->objects.size(); ++i) state->objects[i].hierarchy = &state->hierarchies[i];
    state->refiner.emplace(state->objects);
    return true;
  });
}

EMSCRIPTEN_KEEPALIVE bool occlod_set_transform(RefinerState* state, std::size_t object) {
  return guarded([&] {
    if (object >= state->objects.size())
      throw Error({"refiner", fmt::format("object {}", object), "does not exist", "objects are counted from 0"});
    glm::dmat4& transform = state->objects[object].object_to_world;
    const glm::dmat4 given = transform_of_numbers(state->hierarchies[object].data().origin);
    state->refiner->set_transform(object, given);
    transform = given;
    return true;
  });
}

// numbers: a camera in, RefineStats out.
EMSCRIPTEN_KEEPALIVE bool occlod_refine(RefinerState* state, bool going_on, bool occlusion, bool conservative,
                                        std::size_t budget, double tolerance_px) {
  state->last = nullptr;
  return guarded([&] {
    const View view = view_of_numbers();
    Visibility& visibility = occlusion ? *state->software : static_cast<Visibility&>(state->none);
    const RefineOptions options{.budget = budget,
                                .tolerance_px = tolerance_px,
                                .mode = conservative ? OccluderMode::conservative : OccluderMode::paper};
    Refiner& refiner = *state->refiner;
    state->last = going_on ? &refiner.update(view, options, visibility) : &refiner.refine(view, options, visibility);
    const RefineStats& s = state->last->stats;
    numbers = {static_cast<double>(s.triangles),
               static_cast<double>(s.changed_triangles),
               static_cast<double>(s.queries),
               static_cast<double>(s.queries_hidden),
               s.max_error_px,
               s.max_quadric_error_px,
               s.level_px,
               s.refine_ms,
               s.occlusion_ms};
    return true;
  });
}

// Of the last refinement: 3 ids of positions for each triangle.
EMSCRIPTEN_KEEPALIVE const Bytes* occlod_triangles(const RefinerState* state, std::size_t object) {
  return bytes_of<Triangle>(state->last->objects[object].triangles);
}
// First and count of the triangles that have changed.
EMSCRIPTEN_KEEPALIVE const Bytes* occlod_changes(const RefinerState* state, std::size_t object) {
  return bytes_of<TriangleRange>(state->last->objects[object].changes);
}
// Refinement::hash() as 16 hexadecimal digits.
EMSCRIPTEN_KEEPALIVE const char* occlod_hash(const RefinerState* state) {
  text = fmt::format("{:016x}", state->last->hash());
  return text.c_str();
}

// numbers: a camera. Tells of each triangle of all objects how it is seen: 0 owns a pixel, 1 hidden or smaller than a
// pixel, 2 facing away, 3 off screen.
EMSCRIPTEN_KEEPALIVE const Bytes* occlod_seen(const RefinerState* state) {
  return guarded([&] {
    const View view = view_of_numbers();
    items.reset(view.width(), view.height());
    std::vector<ObjectView> views;
    std::uint32_t count = 0;
    for (std::size_t i = 0; i < state->objects.size(); ++i) {
      const auto& triangles = state->last->objects[i].triangles;
      views.emplace_back(view, state->objects[i].object_to_world);
      draw_items(items, state->hierarchies[i].positions(), triangles, views[i].object_to_clip(), count);
      count += static_cast<std::uint32_t>(triangles.size());
    }
    const std::vector<bool> owns = visible_items(items, count);
    kept.clear();
    for (std::size_t i = 0; i < state->objects.size(); ++i)
      for (const Triangle& t : state->last->objects[i].triangles) {
        const auto positions = state->hierarchies[i].positions();
        const bool back = !state->objects[i].two_sided && !faces_eye(t, positions, views[i].eye());
        kept.push_back(owns[kept.size()] ? 0 : outside_a_plane(t, positions, views[i]) ? 3 : back ? 2 : 1);
      }
    return bytes_of<std::uint8_t>(kept);
  });
}

// Undoes `zstd --patch-from`: of bin/occlod.js, whose module has much of this one.
EMSCRIPTEN_KEEPALIVE const Bytes* occlod_patched(const std::byte* base, std::size_t base_size, const std::byte* patch,
                                                 std::size_t patch_size) {
  return guarded([&] {
    const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(), ZSTD_freeDCtx);
    const unsigned long long size = ZSTD_getFrameContentSize(patch, patch_size);
    kept.resize(size < ZSTD_CONTENTSIZE_ERROR ? static_cast<std::size_t>(size) : 0);
    if (context == nullptr || ZSTD_isError(ZSTD_DCtx_refPrefix(context.get(), base, base_size)) != 0 ||
        ZSTD_decompressDCtx(context.get(), kept.data(), kept.size(), patch, patch_size) != kept.size())
      throw Error({"occlod", "", "has a damaged command line", "install it again"});
    return bytes_of<std::uint8_t>(kept);
  });
}

}  // extern "C"
