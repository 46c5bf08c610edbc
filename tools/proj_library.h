// PROJ, opened when a coordinate system is asked for: linked, it and the libraries that it brings would make every
// command start three times as slowly.
#pragma once

#include <proj.h>

static_assert(PROJ_AT_LEAST_VERSION(9, 1, 0),
              "occlod tiles --crs needs PROJ 9.1: configure with -DOCCLOD_WITH_PROJ=OFF");

namespace occlod::tool {

// The functions that are used. Their types are those of the header, by which PROJ 9 has kept its library the same.
struct ProjLibrary {
// clang-format off
// NOLINTNEXTLINE(cppcoreguidelines-macro-usage): each name once
#define OCCLOD_PROJ_FUNCTIONS(X)                                                                                     \
  X(clone) X(context_create) X(context_destroy) X(context_get_database_path) X(coord)                               \
  X(coordoperation_get_accuracy) X(coordoperation_get_grid_used) X(coordoperation_get_grid_used_count) X(create)    \
  X(create_crs_to_crs_from_pj) X(create_operation_factory_context) X(create_operations)                             \
  X(crs_get_coordinate_system) X(crs_get_sub_crs) X(cs_get_axis_count) X(cs_get_axis_info) X(destroy)               \
  X(get_area_of_use) X(get_name) X(get_source_crs) X(get_type) X(is_crs) X(list_destroy) X(list_get)                \
  X(list_get_count) X(log_func) X(log_level) X(normalize_for_visualization) X(operation_factory_context_destroy)    \
  X(operation_factory_context_set_allow_ballpark_transformations)                                                   \
  X(operation_factory_context_set_grid_availability_use) X(operation_factory_context_set_spatial_criterion)         \
  X(trans) X(trans_get_last_used_operation)
// clang-format on
#define OCCLOD_PROJ_FUNCTION(name) decltype(&::proj_##name) name;
  OCCLOD_PROJ_FUNCTIONS(OCCLOD_PROJ_FUNCTION)
#undef OCCLOD_PROJ_FUNCTION
};

// Returns PROJ, opened by the first call. Throws Error where it is not installed, or too old. Any number of threads may
// call it.
[[nodiscard]] const ProjLibrary& proj();

}  // namespace occlod::tool
