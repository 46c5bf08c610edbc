// NumPy arrays in and out. Out are views: arrays over memory of ours, which keep a Python object alive that owns it.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstddef>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "gil.h"
#include "occlod/mesh.h"

namespace occlod::python {

namespace nb = nanobind;

// Anything that numpy.asarray() takes.
struct ArrayLike {
  nb::object value;
};

template <typename T>
using Array1 = nb::ndarray<nb::numpy, T, nb::shape<-1>>;
template <typename T, nb::ssize_t columns>
using Array2 = nb::ndarray<nb::numpy, T, nb::shape<-1, columns>>;
template <typename T>
using ImageArray = nb::ndarray<nb::numpy, T, nb::shape<-1, -1>>;
using ColorImage = nb::ndarray<nb::numpy, const std::uint8_t, nb::shape<-1, -1, 4>>;

// A view of n records of `columns` values, whose first values lie `stride` values apart; of anything when there are
// none.
template <typename T, nb::ssize_t columns>
Array2<T, columns> rows_view(T* data, std::size_t n, nb::handle owner, std::size_t stride = columns) {
  static std::remove_const_t<T> nothing[static_cast<std::size_t>(columns)] = {};
  const std::size_t shape[2] = {n, static_cast<std::size_t>(columns)};
  const std::int64_t strides[2] = {static_cast<std::int64_t>(stride), 1};
  return Array2<T, columns>(n == 0 ? nothing : data, 2, shape, owner, strides);
}

// The same of single values.
template <typename T>
Array1<T> values_view(T* data, std::size_t n, nb::handle owner, std::size_t stride = 1) {
  static std::remove_const_t<T> nothing = {};
  const std::size_t shape[1] = {n};
  const std::int64_t strides[1] = {static_cast<std::int64_t>(stride)};
  return Array1<T>(n == 0 ? &nothing : data, 1, shape, owner, strides);
}

inline Array2<const float, 3> view_of(std::span<const glm::vec3> values, nb::handle owner) {
  return rows_view<const float, 3>(reinterpret_cast<const float*>(values.data()), values.size(), owner);
}
inline Array2<const float, 2> view_of(std::span<const glm::vec2> values, nb::handle owner) {
  return rows_view<const float, 2>(reinterpret_cast<const float*>(values.data()), values.size(), owner);
}
inline Array2<const std::uint8_t, 4> view_of(std::span<const glm::u8vec4> values, nb::handle owner) {
  return rows_view<const std::uint8_t, 4>(reinterpret_cast<const std::uint8_t*>(values.data()), values.size(), owner);
}
inline Array2<const std::uint16_t, 2> view_of(std::span<const glm::u16vec2> values, nb::handle owner) {
  return rows_view<const std::uint16_t, 2>(reinterpret_cast<const std::uint16_t*>(values.data()), values.size(), owner);
}
inline Array2<const std::uint32_t, 3> view_of(std::span<const Triangle> values, nb::handle owner) {
  return rows_view<const std::uint32_t, 3>(reinterpret_cast<const std::uint32_t*>(values.data()), values.size(), owner);
}
template <typename T>
Array1<const T> view_of(std::span<const T> values, nb::handle owner) {
  return values_view<const T>(values.data(), values.size(), owner);
}

// An array that owns the vector.
template <typename Vector>
nb::capsule owner_of(std::unique_ptr<Vector> vector) {
  return nb::capsule(vector.release(), [](void* p) noexcept { delete static_cast<Vector*>(p); });
}
template <typename T>
Array1<T> array_of(std::vector<T> values) {
  auto kept = std::make_unique<std::vector<T>>(std::move(values));
  T* const data = kept->data();
  const std::size_t n = kept->size();
  return values_view<T>(data, n, owner_of(std::move(kept)));
}
template <typename T, nb::ssize_t columns>
Array2<T, columns> rows_array_of(std::vector<T> values) {
  auto kept = std::make_unique<std::vector<T>>(std::move(values));
  T* const data = kept->data();
  const std::size_t n = kept->size() / columns;
  return rows_view<T, columns>(data, n, owner_of(std::move(kept)));
}

// The vertices of a mesh: (n, 3), of any type of number. Sets its positions and its origin; its triangles say which are
// used. TypeError as below.
void set_coordinates(TriangleMesh& mesh, const ArrayLike& array, const char* name);

// Copies of arrays of the shapes (n, 3), (n, 2) and (n, 4), of any type of number. TypeError for another shape or type.
[[nodiscard]] std::vector<glm::vec3> to_vectors(const ArrayLike& array, const char* name);
[[nodiscard]] std::vector<glm::vec2> to_coordinates(const ArrayLike& array, const char* name);
[[nodiscard]] std::vector<glm::u8vec4> to_colors(const ArrayLike& array, const char* name);
// Of integers of any type; ValueError for what is negative or has more than 32 bits.
[[nodiscard]] std::vector<Triangle> to_triangles(const ArrayLike& array, const char* name);
[[nodiscard]] std::vector<std::uint32_t> to_ids(const ArrayLike& array, const char* name);
// The same with 16 bits.
[[nodiscard]] std::vector<MaterialId> to_material_ids(const ArrayLike& array, const char* name);
// Of the shape (4, 4), to be multiplied with columns from the right: element [0][3] moves along x.
[[nodiscard]] glm::dmat4 to_matrix(const ArrayLike& array, const char* name);
[[nodiscard]] nb::object from_matrix(const glm::dmat4& matrix);

// The array itself if it is one of this type, shape (n, columns) and C order, else a copy that is.
[[nodiscard]] nb::object contiguous(const ArrayLike& array, const char* name, const char* dtype, std::size_t columns);

}  // namespace occlod::python

namespace nanobind::detail {

template <>
struct type_caster<occlod::python::ArrayLike> {
  NB_TYPE_CASTER(occlod::python::ArrayLike, const_name("numpy.typing.ArrayLike"))

  bool from_python(handle source, std::uint8_t, cleanup_list*) noexcept {
    if (source.is_none()) return false;
    value.value = borrow(source);
    return true;
  }
};

// Three numbers.
template <typename T>
struct vec3_caster {
  using Vec = glm::vec<3, T, glm::defaultp>;
  NB_TYPE_CASTER(Vec, io_name("collections.abc.Sequence[float]", "tuple[float, float, float]"))

  bool from_python(handle source, std::uint8_t, cleanup_list*) noexcept {
    if (PySequence_Check(source.ptr()) == 0 || PySequence_Size(source.ptr()) != 3) {
      PyErr_Clear();
      return false;
    }
    for (int i = 0; i < 3; ++i) {
      const object item = steal(PySequence_GetItem(source.ptr(), i));
      const double number = item.is_valid() ? PyFloat_AsDouble(item.ptr()) : 0.0;
      if (PyErr_Occurred() != nullptr) {
        PyErr_Clear();
        return false;
      }
      value[i] = static_cast<T>(number);
    }
    return true;
  }
  static handle from_cpp(const Vec& source, rv_policy, cleanup_list*) noexcept {
    return make_tuple(static_cast<double>(source.x), static_cast<double>(source.y), static_cast<double>(source.z))
        .release();
  }
};
template <>
struct type_caster<glm::dvec3> : vec3_caster<double> {};
template <>
struct type_caster<glm::vec3> : vec3_caster<float> {};

}  // namespace nanobind::detail
