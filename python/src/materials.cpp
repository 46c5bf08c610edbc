// Materials and their textures: values that do not change, so that nobody writes into a copy.
#include "materials.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>

#include <tuple>

#include "bindings.h"

namespace occlod::python {
namespace {

using namespace nb::literals;

using Channels = std::tuple<float, float, float, float>;

Texture make_texture(const std::string& file, const std::string& mime_type, const nb::bytes& bytes, TextureWrap wrap_s,
                     TextureWrap wrap_t) {
  const auto* const first = static_cast<const std::uint8_t*>(bytes.data());
  return {file, mime_type, {first, first + bytes.size()}, wrap_s, wrap_t};
}

Material make_material(const std::string& name, const Channels& base_color, std::optional<TextureId> texture) {
  const auto [r, g, b, a] = base_color;
  return {name, {r, g, b, a}, texture.value_or(no_texture)};
}

// Bytes that are not UTF-8 are escaped.
nb::str file_name(const std::string& bytes) {
  return nb::steal<nb::str>(PyUnicode_DecodeFSDefaultAndSize(bytes.data(), static_cast<Py_ssize_t>(bytes.size())));
}

template <typename Value>
void bind_comparison(nb::class_<Value>& type) {
  type.def(
          "__eq__",
          [](const Value& a, const nb::object& b) {
            return nb::isinstance<Value>(b) && a == nb::cast<const Value&>(b);
          },
          nb::sig("def __eq__(self, other: object, /) -> bool"))
      .attr("__hash__") = nb::none();
}

}  // namespace

void bind_materials(nb::module_& m) {
  nb::enum_<TextureOrigin>(m, "TextureOrigin", "Where texture coordinates begin.")
      .value("bottom_left", TextureOrigin::bottom_left, "OBJ, PLY: v grows upwards.")
      .value("top_left", TextureOrigin::top_left, "glTF: v grows downwards.");
  nb::enum_<TextureWrap>(m, "TextureWrap", "What a texture shows beyond [0, 1].")
      .value("repeat", TextureWrap::repeat)
      .value("clamp", TextureWrap::clamp)
      .value("mirror", TextureWrap::mirror);

  nb::class_<Texture> texture(m, "Texture", "An image that materials name. It is passed on and never decoded.");
  texture
      .def(
          "__init__",
          [](Texture* self, const std::string& file, const std::string& mime_type, const nb::bytes& bytes,
             TextureWrap wrap_s,
             TextureWrap wrap_t) { new (self) Texture(make_texture(file, mime_type, bytes, wrap_s, wrap_t)); },
          "file"_a = "", nb::kw_only(), "mime_type"_a = "", "bytes"_a = nb::bytes("", 0),
          "wrap_s"_a = TextureWrap::repeat, "wrap_t"_a = TextureWrap::repeat)
      .def_prop_ro(
          "file", [](const Texture& t) { return file_name(t.file); },
          "As the mesh file names it, relative to that file; empty when embedded. Bytes that are not UTF-8 are\n"
          "escaped as by os.fsdecode().")
      .def_ro("mime_type", &Texture::mime_type, "Of `bytes`, such as image/png; empty without.")
      .def_prop_ro(
          "bytes", [](const Texture& t) { return nb::bytes(t.bytes.data(), t.bytes.size()); },
          "The encoded image where the mesh file holds it; else empty.")
      .def_ro("wrap_s", &Texture::wrap_s, "Along the first coordinate.")
      .def_ro("wrap_t", &Texture::wrap_t, "Along the second coordinate.")
      .def("__repr__", [](const Texture& t) {
        return file_name("<occlod.Texture " +
                         (t.bytes.empty() ? "\"" + t.file + "\"" : "of " + std::to_string(t.bytes.size()) + " bytes") +
                         ">");
      });
  bind_comparison(texture);

  nb::class_<Material> material(m, "Material", "How a surface looks, as far as a base colour says it.");
  material
      .def(
          "__init__",
          [](Material* self, const std::string& name, const Channels& base_color, std::optional<TextureId> image) {
            new (self) Material(make_material(name, base_color, image));
          },
          "name"_a = "", nb::kw_only(), "base_color"_a = Channels{1.0F, 1.0F, 1.0F, 1.0F}, "texture"_a = nb::none())
      .def_ro("name", &Material::name)
      .def_prop_ro(
          "base_color",
          [](const Material& v) {
            return Channels{v.base_color.r, v.base_color.g, v.base_color.b, v.base_color.a};
          },
          "Linear light and alpha, in [0, 1]; multiplies the texture.")
      .def_prop_ro(
          "texture",
          [](const Material& v) {
            return v.texture == no_texture ? std::nullopt : std::optional<TextureId>(v.texture);
          },
          "Of the base colour: an index into the textures of the mesh; or None.")
      .def("__repr__", [](const Material& v) { return "<occlod.Material \"" + v.name + "\">"; });
  bind_comparison(material);
}

}  // namespace occlod::python
