#include "arrays.h"

#include <cstring>
#include <string>

#include "text.h"

namespace occlod::python {
namespace {

nb::module_ numpy() { return nb::module_::import_("numpy"); }

std::string shape_text(std::size_t columns) { return columns == 0 ? "(n,)" : "(n, " + std::to_string(columns) + ")"; }

// An array of the shape (n, columns), or (n,) for 0 columns, whose kind of type is one of `kinds` (numpy.dtype.kind).
nb::object checked(const ArrayLike& array, const char* name, const char* kinds, std::size_t columns) {
  nb::object values = numpy().attr("asarray")(array.value);
  const auto shape = nb::cast<nb::tuple>(values.attr("shape"));
  const bool fits = columns == 0 ? shape.size() == 1 : shape.size() == 2 && nb::cast<std::size_t>(shape[1]) == columns;
  if (!fits)
    throw nb::type_error((std::string(name) + ": wrong shape; give an array of " + shape_text(columns)).c_str());
  const auto kind = nb::cast<std::string>(values.attr("dtype").attr("kind"));
  if (nb::cast<std::size_t>(values.attr("size")) > 0 && std::strchr(kinds, kind[0]) == nullptr)
    throw nb::type_error((std::string(name) + ": wrong type of element; give " +
                          (std::strchr(kinds, 'f') != nullptr ? "numbers" : "integers"))
                             .c_str());
  return values;
}

nb::object converted(const nb::object& values, const char* dtype) {
  return numpy().attr("ascontiguousarray")(values, dtype);
}

template <typename T>
std::vector<T> copied(const nb::object& values) {
  const auto bytes = nb::cast<std::size_t>(values.attr("nbytes"));
  const auto address = nb::cast<std::uintptr_t>(values.attr("ctypes").attr("data"));
  std::vector<T> result(bytes / sizeof(T));
  if (bytes > 0) std::memcpy(result.data(), reinterpret_cast<const void*>(address), bytes);  // NOLINT
  return result;
}

nb::object checked_ids(const ArrayLike& array, const char* name, std::size_t columns, const char* dtype = "uint32") {
  const std::uint64_t most = std::strcmp(dtype, "uint16") == 0 ? 0xffffU : 0xffffffffU;
  nb::object values = checked(array, name, "iu", columns);
  if (nb::cast<std::size_t>(values.attr("size")) > 0) {
    const auto kind = nb::cast<std::string>(values.attr("dtype").attr("kind"));
    const bool is_negative = kind == "i" && nb::cast<std::int64_t>(nb::int_(nb::object(values.attr("min")()))) < 0;
    if (is_negative || nb::cast<std::uint64_t>(nb::int_(nb::object(values.attr("max")()))) > most)
      throw nb::value_error((std::string(name) + ": ids are from 0 to " + std::to_string(most)).c_str());
  }
  return converted(values, dtype);
}

}  // namespace

nb::object contiguous(const ArrayLike& array, const char* name, const char* dtype, std::size_t columns) {
  if (std::strcmp(dtype, "uint32") == 0) return checked_ids(array, name, columns);
  return converted(checked(array, name, dtype[0] == 'u' ? "u" : "fiu", columns), dtype);
}

void set_coordinates(TriangleMesh& mesh, const ArrayLike& array, const char* name) {
  const nb::object values = checked(array, name, "fiu", 3);
  const nb::object dtype = values.attr("dtype");
  const bool are_floats =
      nb::cast<std::string>(dtype.attr("kind")) == "f" && nb::cast<int>(dtype.attr("itemsize")) <= 4;
  if (are_floats)
    mesh.positions = copied<glm::vec3>(converted(values, "float32"));
  else
    occlod::set_coordinates(mesh, copied<glm::dvec3>(converted(values, "float64")));
}

std::vector<glm::vec3> to_vectors(const ArrayLike& array, const char* name) {
  return copied<glm::vec3>(contiguous(array, name, "float32", 3));
}

std::vector<glm::vec2> to_coordinates(const ArrayLike& array, const char* name) {
  return copied<glm::vec2>(contiguous(array, name, "float32", 2));
}

std::vector<glm::u8vec4> to_colors(const ArrayLike& array, const char* name) {
  nb::object values = numpy().attr("asarray")(array.value);
  if (nb::cast<std::string>(values.attr("dtype").attr("name")) != "uint8")
    throw nb::type_error((std::string(name) + ": wrong type of element; give uint8, 0 to 255").c_str());
  return copied<glm::u8vec4>(contiguous(array, name, "uint8", 4));
}

std::vector<Triangle> to_triangles(const ArrayLike& array, const char* name) {
  return copied<Triangle>(checked_ids(array, name, 3));
}

std::vector<std::uint32_t> to_ids(const ArrayLike& array, const char* name) {
  return copied<std::uint32_t>(checked_ids(array, name, 0));
}

std::vector<MaterialId> to_material_ids(const ArrayLike& array, const char* name) {
  return copied<MaterialId>(checked_ids(array, name, 0, "uint16"));
}

glm::dmat4 to_matrix(const ArrayLike& array, const char* name) {
  const auto values = copied<double>(converted(checked(array, name, "fiu", 4), "float64"));
  if (values.size() != 16) throw nb::type_error((std::string(name) + ": wrong shape; give an array of (4, 4)").c_str());
  glm::dmat4 matrix;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) matrix[column][row] = values[static_cast<std::size_t>(4 * row + column)];
  return matrix;
}

nb::object from_matrix(const glm::dmat4& matrix) {
  std::vector<double> values(16);
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) values[static_cast<std::size_t>(4 * row + column)] = matrix[column][row];
  return nb::cast(rows_array_of<double, 4>(std::move(values)));
}

}  // namespace occlod::python
