// Materials and their textures: values that do not change, so that nobody writes into a copy.
#include "materials.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/tuple.h>

#include <tuple>

#include "arrays.h"
#include "bindings.h"
#include "text.h"

namespace occlod::python {
namespace {

using namespace nb::literals;

using Channels = std::tuple<float, float, float, float>;

using Pair = std::tuple<float, float>;
using Color = std::tuple<float, float, float>;

// For pickling.
using MapState = std::tuple<TextureId, float, Pair, float, Pair>;
using SurfaceState =
    std::tuple<AlphaMode, float, bool, bool, float, float, glm::vec3, TextureMap, TextureMap, TextureMap, TextureMap>;
using TextureState =
    std::tuple<std::string, std::string, nb::bytes, TextureWrap, TextureWrap, std::uint16_t, std::uint16_t>;
using MaterialState = std::tuple<std::string, Channels, std::optional<TextureId>, Surface>;

struct Wraps {
  TextureWrap s, t;
};
struct Filters {
  std::uint16_t min, mag;
};

Texture make_texture(const std::string& file, const std::string& mime_type, const nb::bytes& bytes, const Wraps& wraps,
                     const Filters& filters) {
  const auto* const first = static_cast<const std::uint8_t*>(bytes.data());
  return {file, mime_type, {first, first + bytes.size()}, wraps.s, wraps.t, filters.min, filters.mag};
}

Material make_material(const std::string& name, const Channels& base_color, std::optional<TextureId> texture,
                       const Surface& surface) {
  const auto [r, g, b, a] = base_color;
  return {name, {r, g, b, a}, texture.value_or(no_texture), surface};
}

std::optional<TextureId> id_or_none(TextureId id) {
  return id == no_texture ? std::nullopt : std::optional<TextureId>(id);
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

void bind_maps(nb::module_& m) {
  nb::class_<TextureMap> map(m, "TextureMap", "An image of a material beside that of its base colour.");
  map.def(
         "__init__",
         [](TextureMap* self, std::optional<TextureId> texture, float strength, const Pair& offset, float rotation,
            const Pair& scale) {
           new (self) TextureMap{texture.value_or(no_texture),
                                 strength,
                                 {std::get<0>(offset), std::get<1>(offset)},
                                 rotation,
                                 {std::get<0>(scale), std::get<1>(scale)}};
         },
         "texture"_a = nb::none(), nb::kw_only(), "strength"_a = 1.0F, "offset"_a = Pair{0.0F, 0.0F},
         "rotation"_a = 0.0F, "scale"_a = Pair{1.0F, 1.0F})
      .def_prop_ro(
          "texture", [](const TextureMap& v) { return id_or_none(v.texture); },
          "An index into the textures of the mesh; or None.")
      .def_ro("strength", &TextureMap::strength, "Of normals, where glTF calls it scale, and of occlusion.")
      .def_prop_ro(
          "offset",
          [](const TextureMap& v) {
            return Pair{v.offset.x, v.offset.y};
          },
          "The image shows rotation * (scale * (u, v)) + offset, v growing downwards.")
      .def_ro("rotation", &TextureMap::rotation, "Radians, counter-clockwise.")
      .def_prop_ro("scale", [](const TextureMap& v) {
        return Pair{v.scale.x, v.scale.y};
      });
  map.def("__getstate__",
          [](const TextureMap& v) {
            return MapState(v.texture, v.strength, {v.offset.x, v.offset.y}, v.rotation, {v.scale.x, v.scale.y});
          })
      .def("__setstate__", [](TextureMap& self, const MapState& state) {
        const auto& [texture, strength, offset, rotation, scale] = state;
        new (&self) TextureMap{texture,
                               strength,
                               {std::get<0>(offset), std::get<1>(offset)},
                               rotation,
                               {std::get<0>(scale), std::get<1>(scale)}};
      });
  bind_comparison(map);

  nb::class_<Surface> surface(
      m, "Surface",
      "How a surface looks beyond its base colour, as glTF describes it. Passed on; pictures do\n"
      "not show it.");
  surface
      .def(
          "__init__",
          [](Surface* self, AlphaMode alpha_mode, float alpha_cutoff, bool double_sided, bool unlit, float metallic,
             float roughness, const Color& emissive, const TextureMap& metallic_map, const TextureMap& normal_map,
             const TextureMap& occlusion_map, const TextureMap& emissive_map) {
            const auto [r, g, b] = emissive;
            new (self) Surface{alpha_mode, alpha_cutoff, double_sided, unlit,         metallic,    roughness,
                               {r, g, b},  metallic_map, normal_map,   occlusion_map, emissive_map};
          },
          nb::kw_only(), "alpha_mode"_a = AlphaMode::by_color, "alpha_cutoff"_a = 0.5F, "double_sided"_a = false,
          "unlit"_a = false, "metallic"_a = 0.0F, "roughness"_a = 1.0F, "emissive"_a = Color{0.0F, 0.0F, 0.0F},
          "metallic_map"_a = TextureMap{}, "normal_map"_a = TextureMap{}, "occlusion_map"_a = TextureMap{},
          "emissive_map"_a = TextureMap{})
      .def_ro("alpha_mode", &Surface::alpha_mode)
      .def_ro("alpha_cutoff", &Surface::alpha_cutoff, "With AlphaMode.mask.")
      .def_ro("double_sided", &Surface::double_sided, "Whether its back shows.")
      .def_ro("unlit", &Surface::unlit, "Shows the base colour whatever the light is.")
      .def_ro("metallic", &Surface::metallic, "In [0, 1]; multiplies the blue of its map.")
      .def_ro("roughness", &Surface::roughness, "In [0, 1]; multiplies the green of metallic_map.")
      .def_prop_ro(
          "emissive",
          [](const Surface& v) {
            return Color{v.emissive.r, v.emissive.g, v.emissive.b};
          },
          "Linear light, in [0, 1]; multiplies its map.")
      .def_ro("metallic_map", &Surface::metallic_map, nb::rv_policy::copy)
      .def_ro("normal_map", &Surface::normal_map, nb::rv_policy::copy)
      .def_ro("occlusion_map", &Surface::occlusion_map, nb::rv_policy::copy)
      .def_ro("emissive_map", &Surface::emissive_map, nb::rv_policy::copy)
      .def("__getstate__",
           [](const Surface& v) {
             return SurfaceState(v.alpha_mode, v.alpha_cutoff, v.double_sided, v.unlit, v.metallic, v.roughness,
                                 v.emissive, v.metallic_map, v.normal_map, v.occlusion_map, v.emissive_map);
           })
      .def("__setstate__", [](Surface& self, const SurfaceState& state) {
        new (&self) Surface(std::apply([](const auto&... fields) { return Surface{fields...}; }, state));
      });
  bind_comparison(surface);
}

}  // namespace

void bind_materials(nb::module_& m) {
  nb::enum_<UpAxis>(m, "UpAxis", "Which axis points up, as far as files say.")
      .value("z", UpAxis::z, "All but glTF, which do not say.")
      .value("y", UpAxis::y, "glTF.");
  nb::enum_<AlphaMode>(m, "AlphaMode", "How the alpha of a base colour and its texture counts.")
      .value("by_color", AlphaMode::by_color, "Blends if the base colour's alpha is below 1; else alpha is ignored.")
      .value("mask", AlphaMode::mask, "Shows what has at least Surface.alpha_cutoff.")
      .value("blend", AlphaMode::blend);
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
             TextureWrap wrap_s, TextureWrap wrap_t, std::uint16_t min_filter, std::uint16_t mag_filter) {
            new (self) Texture(make_texture(file, mime_type, bytes, {wrap_s, wrap_t}, {min_filter, mag_filter}));
          },
          "file"_a = "", nb::kw_only(), "mime_type"_a = "", "bytes"_a = nb::bytes("", 0),
          "wrap_s"_a = TextureWrap::repeat, "wrap_t"_a = TextureWrap::repeat, "min_filter"_a = 0, "mag_filter"_a = 0)
      .def_ro("file", &Texture::file,
              "As the mesh file names it, relative to that file; empty when embedded. Bytes that are not UTF-8 are\n"
              "escaped as by os.fsdecode().")
      .def_ro("mime_type", &Texture::mime_type, "Of `bytes`, such as image/png; empty without.")
      .def_prop_ro(
          "bytes", [](const Texture& t) { return nb::bytes(t.bytes.data(), t.bytes.size()); },
          "The encoded image where the mesh file holds it; else empty.")
      .def_ro("wrap_s", &Texture::wrap_s, "Along the first coordinate.")
      .def_ro("wrap_t", &Texture::wrap_t, "Along the second coordinate.")
      .def_ro("min_filter", &Texture::min_filter, "As glTF numbers them, such as 9987; 0: the viewer chooses.")
      .def_ro("mag_filter", &Texture::mag_filter, "Likewise.")
      .def(
          "__getstate__",
          [](const Texture& t) {
            return TextureState(t.file, t.mime_type, nb::bytes(t.bytes.data(), t.bytes.size()), t.wrap_s, t.wrap_t,
                                t.min_filter, t.mag_filter);
          },
          nb::sig("def __getstate__(self) -> tuple[object, ...]"))
      .def(
          "__setstate__",
          [](Texture& self, const TextureState& state) {
            const auto& [file, mime_type, bytes, wrap_s, wrap_t, min_filter, mag_filter] = state;
            new (&self) Texture(make_texture(file, mime_type, bytes, {wrap_s, wrap_t}, {min_filter, mag_filter}));
          },
          nb::sig("def __setstate__(self, state: tuple[object, ...], /) -> None"))
      .def("__repr__", [](const Texture& t) {
        return "<occlod.Texture " +
               (t.bytes.empty() ? "\"" + t.file + "\"" : "of " + std::to_string(t.bytes.size()) + " bytes") + ">";
      });
  bind_comparison(texture);

  bind_maps(m);
  nb::class_<Material> material(m, "Material", "How a surface looks.");
  material
      .def(
          "__init__",
          [](Material* self, const std::string& name, const Channels& base_color, std::optional<TextureId> image,
             const Surface& beyond) { new (self) Material(make_material(name, base_color, image, beyond)); },
          "name"_a = "", nb::kw_only(), "base_color"_a = Channels{1.0F, 1.0F, 1.0F, 1.0F}, "texture"_a = nb::none(),
          "surface"_a = Surface{})
      .def_ro("name", &Material::name)
      .def_prop_ro(
          "base_color",
          [](const Material& v) {
            return Channels{v.base_color.r, v.base_color.g, v.base_color.b, v.base_color.a};
          },
          "Linear light and alpha, in [0, 1]; multiplies the texture.")
      .def_prop_ro(
          "texture", [](const Material& v) { return id_or_none(v.texture); },
          "Of the base colour: an index into the textures of the mesh; or None.")
      .def_ro("surface", &Material::surface, nb::rv_policy::copy)
      .def("__getstate__",
           [](const Material& v) {
             return MaterialState(v.name, {v.base_color.r, v.base_color.g, v.base_color.b, v.base_color.a},
                                  id_or_none(v.texture), v.surface);
           })
      .def("__setstate__",
           [](Material& self, const MaterialState& state) {
             const auto& [name, base_color, image, surface] = state;
             new (&self) Material(make_material(name, base_color, image, surface));
           })
      .def("__repr__", [](const Material& v) { return "<occlod.Material \"" + v.name + "\">"; });
  bind_comparison(material);
}

}  // namespace occlod::python
