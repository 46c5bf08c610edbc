#include "map_system.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <glm/common.hpp>
#include <limits>
#include <utility>

#include "mesh/mesh_report.h"
#include "option_values.h"

#ifdef OCCLOD_HAS_PROJ
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>
#include <vector>

#include "base/threads.h"
#include "hlod/tiles/tile_tree.h"
#include "proj_library.h"
#include "standard_streams.h"
#endif

namespace occlod::tool {
namespace {

[[noreturn]] void refuse(const std::string& name, const std::string& why) {
  throw CLI::ValidationError("--crs", shown(name) + " " + why);
}

// The box of the coordinates of meshes.
class CoordinateBox final : public hlod::TriangleSink {
 public:
  void add(const TriangleMesh& piece) override {
    for (const glm::vec3& p : piece.positions) {
      low_ = glm::min(low_, piece.origin + glm::dvec3(p));
      high_ = glm::max(high_, piece.origin + glm::dvec3(p));
    }
    up_ = piece.up;  // pieces have the axis of all before them, too
  }
  // Puts the frame into the middle, unless there is nothing.
  void put_frame(MapSystem& system, std::optional<UpAxis> up) const {
    if (low_.x <= high_.x) system.put_frame(low_ + (high_ - low_) / 2.0, up.value_or(up_));
  }

 private:
  glm::dvec3 low_{std::numeric_limits<double>::infinity()};
  glm::dvec3 high_{-std::numeric_limits<double>::infinity()};
  UpAxis up_ = UpAxis::z;
};

// Hands on what it brings to the frame.
class BringingSink final : public hlod::TriangleSink {
 public:
  BringingSink(hlod::TriangleSink& next, const MapSystem& system) : next_(next), system_(system) {}
  void add(const TriangleMesh& piece) override {
    TriangleMesh copy = piece;
    system_.bring(copy);
    next_.add(copy);
  }
  void add_counts(const MeshReport& of_object) override { next_.add_counts(of_object); }

 private:
  hlod::TriangleSink& next_;
  const MapSystem& system_;
};

}  // namespace

CleanMesh brought(CleanMesh input, MapSystem& system, std::optional<UpAxis> up, int threads) {
  CoordinateBox box;
  box.add(input.mesh);
  box.put_frame(system, up);
  system.bring(input.mesh);
  CleanMesh result = clean(std::move(input.mesh), {}, "mesh on Earth", threads);
  result.report = report_of(input.report, result);
  return result;
}

hlod::TriangleSource brought(hlod::TriangleSource source, MapSystem& system, std::optional<UpAxis> up) {
  return [source = std::move(source), &system, up](hlod::TriangleSink& sink) {
    CoordinateBox box;
    source(box);
    box.put_frame(system, up);
    BringingSink bringing(sink, system);
    source(bringing);
  };
}

#ifdef OCCLOD_HAS_PROJ
namespace {

struct EndProj {
  void operator()(PJ_CONTEXT* context) const { proj().context_destroy(context); }
  void operator()(PJ* object) const { proj().destroy(object); }
  void operator()(PJ_OBJ_LIST* list) const { proj().list_destroy(list); }
  void operator()(PJ_OPERATION_FACTORY_CONTEXT* factory) const { proj().operation_factory_context_destroy(factory); }
};
template <class T>
using Owned = std::unique_ptr<T, EndProj>;
using Pj = Owned<PJ>;

bool is_finite(const glm::dvec3& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

glm::dvec3 transformed(PJ* operation, PJ_DIRECTION direction, const glm::dvec3& p) {
  const PJ_XYZ at = proj().trans(operation, direction, proj().coord(p.x, p.y, p.z, HUGE_VAL)).xyz;
  return {at.x, at.y, at.z};
}

// Returns the grid that PROJ would need to know a way between the systems, or nothing.
std::string missing_grid(PJ_CONTEXT* context, const PJ* from, const PJ* to) {
  const Owned<PJ_OPERATION_FACTORY_CONTEXT> factory(proj().create_operation_factory_context(context, nullptr));
  proj().operation_factory_context_set_spatial_criterion(context, factory.get(),
                                                         PROJ_SPATIAL_CRITERION_PARTIAL_INTERSECTION);
  proj().operation_factory_context_set_grid_availability_use(context, factory.get(), PROJ_GRID_AVAILABILITY_IGNORED);
  proj().operation_factory_context_set_allow_ballpark_transformations(context, factory.get(), 0);
  const Owned<PJ_OBJ_LIST> ways(proj().create_operations(context, from, to, factory.get()));
  for (int i = 0; ways && i < proj().list_get_count(ways.get()); ++i) {
    const Pj way(proj().list_get(context, ways.get(), i));
    for (int grid = 0; grid < proj().coordoperation_get_grid_used_count(context, way.get()); ++grid) {
      const char* name = nullptr;
      int is_here = 1;
      if (proj().coordoperation_get_grid_used(context, way.get(), grid, &name, nullptr, nullptr, nullptr, nullptr,
                                              nullptr, &is_here) != 0 &&
          is_here == 0)
        return name;
    }
  }
  return {};
}

// A thread's own PROJ, which may not be shared.
struct Worker {
  Owned<PJ_CONTEXT> context;
  Pj operation;
};

class ProjSystem final : public MapSystem {
 public:
  ProjSystem(const std::string& name, std::string subject, int threads)
      : name_(name), subject_(std::move(subject)), threads_(thread_count(threads)), context_(proj().context_create()) {
    proj().log_func(context_.get(), &message_,
                    [](void* message, int, const char* text) { *static_cast<std::string*>(message) = text; });
    if (proj().context_get_database_path(context_.get()) == nullptr)
      refuse(name, "needs proj.db, which PROJ does not find (" + message_ +
                       "): install proj-data, or set PROJ_DATA to the folder that has it");
    system_.reset(proj().create(context_.get(), name.c_str()));
    if (!system_ || proj().is_crs(system_.get()) == 0)
      refuse(name, "is no coordinate system that PROJ knows: give a code such as EPSG:32633");
    find_heights();
    const Pj earth(proj().create(context_.get(), "EPSG:4978"));
    // What PROJ calls ballpark leaves out the change of heights or of the datum.
    const std::array<const char*, 2> options{"ALLOW_BALLPARK=NO", nullptr};
    const Pj ways(
        proj().create_crs_to_crs_from_pj(context_.get(), system_.get(), earth.get(), nullptr, options.data()));
    if (ways) ways_.reset(proj().normalize_for_visualization(context_.get(), ways.get()));
    if (ways_) return;
    const std::string grid = missing_grid(context_.get(), system_.get(), earth.get());
    refuse(name, grid.empty() ? "has no known relation to WGS84"
                              : "needs the grid " + grid + ": fetch it by `projsync --file " + grid + "`");
  }

  void put_frame(const glm::dvec3& coordinates, UpAxis up) override {
    up_ = up;
    const glm::dvec3 middle = on_map(coordinates);
    // Which way is best depends on the place; all of the mesh goes the same, so that no gap opens.
    const glm::dvec3 earth_centred = transformed(ways_.get(), PJ_FWD, middle);
    const Pj way(is_finite(earth_centred) ? proj().trans_get_last_used_operation(ways_.get()) : nullptr);
    if (!way) refuse_point(coordinates);
    accuracy_m_ = proj().coordoperation_get_accuracy(context_.get(), way.get());
    workers_.clear();
    for (unsigned i = 0; i < threads_; ++i) {
      Worker& worker = workers_.emplace_back();
      worker.context.reset(proj().context_create());
      proj().log_level(worker.context.get(), PJ_LOG_NONE);
      worker.operation.reset(proj().clone(worker.context.get(), way.get()));
    }

    const Pj ellipsoid(proj().create(context_.get(), "+proj=cart +ellps=WGS84"));
    const glm::dvec3 geodetic = transformed(ellipsoid.get(), PJ_INV, earth_centred);
    place_ = {std::clamp(glm::degrees(geodetic.x), -180.0, 180.0), std::clamp(glm::degrees(geodetic.y), -90.0, 90.0),
              geodetic.z};
    const glm::dmat4 frame = tiles::east_north_up(place_);
    to_frame_ = glm::transpose(glm::dmat3(frame));
    frame_origin_ = frame[3];
    is_mirrored_ = glm::determinant(around(workers_[0], middle, in_frame(workers_[0], middle))) < 0.0;
    note_area();
  }

  void bring(TriangleMesh& mesh) const override {
    constexpr std::size_t block = 4096, none = std::numeric_limits<std::size_t>::max();
    std::atomic<std::size_t> first_beyond = none;
    for_each_block(mesh.positions.size(), block, threads_, [&](std::size_t begin, std::size_t end, unsigned thread) {
      for (std::size_t i = begin; i < end; ++i) {
        const glm::dvec3 p = on_map(mesh.origin + glm::dvec3(mesh.positions[i]));
        const glm::dvec3 at = in_frame(workers_[thread], p);
        if (!is_finite(at)) {
          std::size_t first = first_beyond;
          while (i < first && !first_beyond.compare_exchange_weak(first, i)) continue;
          return;
        }
        if (!mesh.normals.empty()) mesh.normals[i] = turned(mesh.normals[i], around(workers_[thread], p, at));
        mesh.positions[i] = glm::vec3(at) + 0.0F;  // never -0
      }
    });
    if (first_beyond != none) refuse_point(mesh.origin + glm::dvec3(mesh.positions[first_beyond]));
    const auto turn_over = [](std::vector<Triangle>& triangles) {
      for (Triangle& t : triangles) std::swap(t.y, t.z);
    };
    if (is_mirrored_) {
      turn_over(mesh.triangles);
      turn_over(mesh.corners);
    }
    mesh.origin = glm::dvec3(0.0);
    mesh.up = UpAxis::z;
  }

  [[nodiscard]] const tiles::GeodeticOrigin& place() const override { return place_; }

  [[nodiscard]] Json told() const override {
    Json json = {{"up", up_ == UpAxis::y ? "y" : "z"}, {"crs", proj().get_name(system_.get())}, {"heights", heights_}};
    if (accuracy_m_ >= 0.0) json["accuracy_m"] = accuracy_m_;
    json["longitude_deg"] = place_.longitude_deg;
    json["latitude_deg"] = place_.latitude_deg;
    json["height_m"] = place_.height_m;
    return json;
  }

 private:
  // Finds out what heights are above, and their unit. Refuses systems whose x and y are none of a map.
  void find_heights() {
    PJ_CONTEXT* const context = context_.get();
    Pj part;  // the system of x and y
    const PJ* map = system_.get();
    if (proj().get_type(map) == PJ_TYPE_COMPOUND_CRS) {
      const Pj vertical(proj().crs_get_sub_crs(context, map, 1));
      heights_ = vertical ? proj().get_name(vertical.get()) : "";
      part.reset(proj().crs_get_sub_crs(context, map, 0));
      map = part.get();
    }
    while (map != nullptr && proj().get_type(map) == PJ_TYPE_BOUND_CRS) {
      part.reset(proj().get_source_crs(context, map));
      map = part.get();
    }
    if (map == nullptr || proj().get_type(map) != PJ_TYPE_PROJECTED_CRS) refuse_unprojected(map);
    if (!heights_.empty()) return;
    heights_ = "above the WGS84 ellipsoid";
    const Pj axes(proj().crs_get_coordinate_system(context, map));
    if (proj().cs_get_axis_count(context, axes.get()) == 2)
      proj().cs_get_axis_info(context, axes.get(), 0, nullptr, nullptr, nullptr, &height_unit_m_, nullptr, nullptr,
                              nullptr);
    else
      heights_ = "of the system";
  }

  [[noreturn]] void refuse_unprojected(const PJ* map) const {
    const PJ_TYPE type = map != nullptr ? proj().get_type(map) : PJ_TYPE_UNKNOWN;
    if (type == PJ_TYPE_GEOGRAPHIC_2D_CRS || type == PJ_TYPE_GEOGRAPHIC_3D_CRS)
      refuse(name_,
             "is geographic, in degrees: bring the mesh to a projected system first, such as that of a UTM zone");
    if (type == PJ_TYPE_GEOCENTRIC_CRS)
      refuse(name_, "is earth-centred: such meshes are where they belong without --crs");
    refuse(name_, "is no projected system: give one such as EPSG:32633, or EPSG:32633+5773 with heights");
  }

  [[noreturn]] void refuse_point(const glm::dvec3& at) const {
    throw Error({subject_, fmt::format("point {}, {}, {}", at.x, at.y, at.z),
                 fmt::format("lies beyond what {} can reach", proj().get_name(system_.get())),
                 "check --crs, and the order and unit of the coordinates"});
  }

  // Tells when the mesh is where the system is not meant to be used: a wrong code, or axes the other way round.
  void note_area() const {
    double west = 0.0, south = 0.0, east = 0.0, north = 0.0;
    const char* area = nullptr;
    if (proj().get_area_of_use(context_.get(), system_.get(), &west, &south, &east, &north, &area) == 0 ||
        west < -180.0)  // unknown
      return;
    const double longitude = place_.longitude_deg, latitude = place_.latitude_deg;
    const bool is_between = west <= east ? longitude >= west && longitude <= east  // or across 180 degrees
                                         : longitude >= west || longitude <= east;
    if (is_between && latitude >= south && latitude <= north) return;
    print_note(fmt::format("{}: its middle is at longitude {:.5f}, latitude {:.5f}, outside the area of {}: {}",
                           subject_, longitude, latitude, proj().get_name(system_.get()), area != nullptr ? area : ""));
  }

  // Returns coordinates of the mesh as the operation takes them.
  [[nodiscard]] glm::dvec3 on_map(const glm::dvec3& p) const {
    const glm::dvec3 z_up = up_ == UpAxis::y ? glm::dvec3(p.x, -p.z, p.y) : p;
    return {z_up.x, z_up.y, z_up.z * height_unit_m_};
  }
  [[nodiscard]] glm::dvec3 in_frame(const Worker& worker, const glm::dvec3& p) const {
    return to_frame_ * (transformed(worker.operation.get(), PJ_FWD, p) - frame_origin_);
  }
  // Returns how far the frame's place moves with each axis of the mesh, z up; p is `at` in the frame.
  [[nodiscard]] glm::dmat3 around(const Worker& worker, const glm::dvec3& p, const glm::dvec3& at) const {
    return {in_frame(worker, p + glm::dvec3(1.0, 0.0, 0.0)) - at, in_frame(worker, p + glm::dvec3(0.0, 1.0, 0.0)) - at,
            in_frame(worker, p + glm::dvec3(0.0, 0.0, height_unit_m_)) - at};
  }
  // Returns a normal of the mesh in the frame; it stands on the surface as before. Not finite at the rim of a system.
  [[nodiscard]] glm::vec3 turned(const glm::vec3& normal, const glm::dmat3& axes) const {
    const glm::dvec3 n = up_ == UpAxis::y ? glm::dvec3(normal.x, -normal.z, normal.y) : glm::dvec3(normal);
    const glm::dvec3 turned =
        n.x * glm::cross(axes[1], axes[2]) + n.y * glm::cross(axes[2], axes[0]) + n.z * glm::cross(axes[0], axes[1]);
    return glm::vec3(glm::normalize(is_mirrored_ ? -turned : turned));
  }

  std::string name_, subject_;
  unsigned threads_;
  std::string message_;  // PROJ's last
  Owned<PJ_CONTEXT> context_;
  Pj system_;
  Pj ways_;  // to WGS84: for each place the best; x to the east and y to the north where the system has such axes
  std::string heights_;
  double height_unit_m_ = 1.0;
  UpAxis up_ = UpAxis::z;
  double accuracy_m_ = -1.0;
  std::vector<Worker> workers_;  // one for each thread, all of the same way
  tiles::GeodeticOrigin place_;
  glm::dmat3 to_frame_{1.0};
  glm::dvec3 frame_origin_{0.0};
  bool is_mirrored_ = false;
};

}  // namespace

std::unique_ptr<MapSystem> find_map_system(const std::string& name, const std::string& subject, int threads) {
  return std::make_unique<ProjSystem>(name, subject, threads);
}
#else
std::unique_ptr<MapSystem> find_map_system(const std::string& name, const std::string&, int) {
  refuse(name, "needs PROJ, which this program was built without: install libproj-dev and build it again");
}
#endif

}  // namespace occlod::tool
