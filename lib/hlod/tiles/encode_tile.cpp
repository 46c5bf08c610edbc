#include "hlod/tiles/encode_tile.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/vec2.hpp>
#include <limits>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "hlod/tiles/feature_table.h"
#include "mesh/glb.h"
#include "mesh/image_files.h"
#include "mesh/mesh_writers.h"
#include "occlod/bounds.h"

#ifdef OCCLOD_HAS_MESHOPTIMIZER
#include <meshoptimizer.h>
#endif

namespace occlod::tiles {

#ifdef OCCLOD_HAS_MESHOPTIMIZER

bool has_meshopt() noexcept { return true; }

void order_for_codec(GlbPrimitive& primitive) {
  std::vector<std::uint32_t> indices;
  indices.reserve(3 * primitive.triangles.size());
  for (const Triangle& t : primitive.triangles) indices.insert(indices.end(), {t.x, t.y, t.z});
  const std::size_t vertices = primitive.wedges.size();
  meshopt_optimizeVertexCacheStrip(indices.data(), indices.data(), indices.size(), vertices);
  std::vector<std::uint32_t> place(vertices);
  const std::size_t used = meshopt_optimizeVertexFetchRemap(place.data(), indices.data(), indices.size(), vertices);
  std::vector<WedgeId> wedges(used);
  for (std::size_t v = 0; v < vertices; ++v)
    if (place[v] != no_id) wedges[place[v]] = primitive.wedges[v];
  primitive.wedges = std::move(wedges);
  for (std::size_t t = 0; t < primitive.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) primitive.triangles[t][k] = place[indices[3 * t + static_cast<std::size_t>(k)]];
}

std::string encode_vertices(const ByteStream& stream) {
  meshopt_encodeVertexVersion(0);
  std::string encoded(meshopt_encodeVertexBufferBound(stream.count(), stream.stride()), '\0');
  encoded.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(encoded.data()), encoded.size(),
                                            stream.bytes().data(), stream.count(), stream.stride()));
  return encoded;
}

std::string encode_triangles(std::span<const std::uint32_t> indices, std::size_t vertices) {
  meshopt_encodeIndexVersion(1);
  std::string encoded(meshopt_encodeIndexBufferBound(indices.size(), vertices), '\0');
  encoded.resize(meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(encoded.data()), encoded.size(),
                                           indices.data(), indices.size()));
  return encoded;
}

#else

bool has_meshopt() noexcept { return false; }
void order_for_codec(GlbPrimitive&) { assert(false); }
std::string encode_vertices(const ByteStream&) { return {}; }
std::string encode_triangles(std::span<const std::uint32_t>, std::size_t) { return {}; }

#endif

namespace {

glm::dvec3 rounded(const glm::dvec3& v) { return {std::nearbyint(v.x), std::nearbyint(v.y), std::nearbyint(v.z)}; }

double largest(const glm::dvec3& v) { return std::max({v.x, v.y, v.z}); }

}  // namespace

glm::dvec3 near_origin(std::span<const glm::vec3> positions) {
  const Box box = bounding_box(positions);
  glm::dvec3 origin(0.0);
  for (int k = 0; k < 3; ++k) {
    const double least = box.min[k], most = box.max[k];
    const double nearest = least > 0.0 ? least : most < 0.0 ? -most : 0.0;
    if (nearest > (most - least) / 2.0) origin[k] = static_cast<double>(static_cast<float>((least + most) / 2.0));
  }
  return origin;
}

TileLattice::TileLattice(std::span<const glm::vec3> positions, int bits) {
  assert(!positions.empty() && bits >= 1 && bits <= 16);
  const Box box = bounding_box(positions);
  const glm::dvec3 low(box.min), high(box.max);
  const double max_steps = std::exp2(bits) - 1.0;
  // Doubles hold 53 bits, some of which the place itself takes.
  const double farthest = largest(glm::max(glm::abs(low), glm::abs(high)));
  const double finest = std::max({largest(high - low) / max_steps, std::ldexp(farthest, -50), std::ldexp(1.0, -149)});
  step_ = std::exp2(std::ceil(std::log2(finest)));
  // Rounding may add a step.
  while (largest(rounded(high / step_) - rounded(low / step_)) > max_steps) step_ *= 2.0;
  least_ = rounded(low / step_);
  far_end_ = glm::u16vec3(rounded(high / step_) - least_);
}

glm::dvec3 TileLattice::origin() const noexcept {
  return glm::dvec3(least_.x, least_.y + far_end_.y, least_.z) * step_;
}

glm::u16vec3 TileLattice::at(const glm::vec3& position) const {
  return glm::u16vec3(rounded(glm::dvec3(position) / step_) - least_);
}

glm::dvec3 TileLattice::position(const glm::u16vec3& at) const { return (least_ + glm::dvec3(at)) * step_; }

namespace {

using Json = GlbDocument::Json;

template <typename Vector>
Vector y_up(const Vector& v) {
  return {v.x, v.z, -v.y};
}

std::int8_t signed_byte(float x) { return static_cast<std::int8_t>(std::lround(127.0F * std::clamp(x, -1.0F, 1.0F))); }

std::uint16_t unsigned_short(float x) { return static_cast<std::uint16_t>(std::lround(65535.0F * x)); }

class TileEncoder {
 public:
  TileEncoder(const TileMesh& tile, const TileLook& look, const TileFormat& format)
      : mesh_(tile.mesh),
        image_(tile.image),
        look_(look),
        format_(format),
        features_(tile, look.feature_names),
        origin_(near_origin(mesh_.positions)) {
    if (format.quantise_bits > 0) lattice_.emplace(mesh_.positions, format.quantise_bits);
  }

  TileContent run(const FileErrors& errors) && {
    for (GlbPrimitive& primitive : glb_primitives(mesh_)) {
      if (is_compressed()) order_for_codec(primitive);
      add(primitive);
    }
    if (!features_.empty()) features_.add_to(document_, buffer_);
    place();
    if (lattice_) document_.use_extension("KHR_mesh_quantization", true);
    if (is_compressed()) {
      document_.use_extension("EXT_meshopt_compression", true);
      // This buffer is for clients without the extension. There are none, because the extension is required.
      document_.json()["buffers"][1] = {{"byteLength", fallback_bytes_},
                                        {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}};
    }
    content_.bytes = document_.head(errors) + buffer_;
    return std::move(content_);
  }

 private:
  [[nodiscard]] bool is_compressed() const { return format_.compression == Compression::meshopt; }

  void place() {
    const glm::dvec3 translation = lattice_ ? y_up(lattice_->origin()) : y_up(origin_);
    document_.node()["translation"] = {translation.x, translation.y, translation.z};
    if (lattice_) document_.node()["scale"] = {lattice_->step(), lattice_->step(), lattice_->step()};
  }

  void add(const GlbPrimitive& primitive) {
    Json attributes;
    attributes["POSITION"] = lattice_ ? add_lattice_positions(primitive) : add_positions(primitive);
    if (!mesh_.normals.empty()) attributes["NORMAL"] = lattice_ ? add_short_normals(primitive) : add_normals(primitive);
    if (needs_texture_coordinates(primitive)) attributes["TEXCOORD_0"] = add_texture_coordinates(primitive);
    if (!mesh_.colors.empty()) attributes["COLOR_0"] = add_colors(primitive);
    if (!features_.empty()) attributes["_FEATURE_ID_0"] = add_feature_ids(primitive);
    Json described = {{"attributes", std::move(attributes)}};
    if (!features_.empty()) described["extensions"]["EXT_mesh_features"] = features_.described(primitive.wedges);
    described["indices"] = add_indices(primitive);
    described["material"] = add_material(primitive.material);
    document_.primitives().push_back(std::move(described));
  }

  [[nodiscard]] bool needs_texture_coordinates(const GlbPrimitive& primitive) const {
    if (mesh_.texture_coordinates.empty()) return false;
    if (look_.materials.empty() || shows_own_image(primitive.material)) return true;
    return std::ranges::any_of(look_.materials[primitive.material].textures(),
                               [this](TextureId id) { return id != no_texture && has_image(id); });
  }

  [[nodiscard]] bool shows_own_image(MaterialId id) const {
    return !image_.bytes.empty() && image_.is_shown_by[id] != 0;
  }
  [[nodiscard]] bool has_image(TextureId id) const { return !look_.images[id].empty(); }

  std::size_t add_material(MaterialId id) {
    Material material = look_.materials.empty() ? Material() : look_.materials[id];
    change_textures(material, [&](TextureId texture) {
      if (shows_own_image(id)) return add_own_texture();
      return has_image(texture) && !mesh_.texture_coordinates.empty() ? add_texture(texture) : no_texture;
    });
    document_.add_material(material);
    Json& materials = document_.json()["materials"];
    materials.back()["doubleSided"] = true;
    return materials.size() - 1;
  }

  // Adds the tile's own image, once.
  TextureId add_own_texture() {
    const auto [known, is_new] = textures_.try_emplace(no_texture, static_cast<TextureId>(textures_.size()));
    if (!is_new) return known->second;
    const std::string type = image_type(image_.bytes);
    const std::size_t view = document_.add_view(image_.bytes.size(), 0);
    buffer_.append(image_.bytes.begin(), image_.bytes.end());
    buffer_.resize((buffer_.size() + 3) / 4 * 4, '\0');
    Texture texture;
    texture.wrap_s = texture.wrap_t = TextureWrap::clamp;
    document_.add_texture(texture, document_.add_image({{"bufferView", view}, {"mimeType", type}}), type);
    return known->second;
  }

  TextureId add_texture(TextureId id) {
    const auto [known, is_new] = textures_.try_emplace(id, static_cast<TextureId>(textures_.size()));
    if (!is_new) return known->second;
    const std::string type = image_type({}, look_.images[id]);
    Json image = {{"uri", uri_of(look_.images[id])}};
    if (!gltf_image_extension(type).value_or("").empty()) image["mimeType"] = type;
    document_.add_texture(look_.textures[id], document_.add_image(std::move(image)), type);
    return known->second;
  }

  // Adds texture coordinates, as integers if they are in [0, 1].
  std::size_t add_texture_coordinates(const GlbPrimitive& primitive) {
    const bool flip = look_.origin != TextureOrigin::top_left;
    const auto at = [&](WedgeId w) {
      const glm::vec2& uv = mesh_.texture_coordinates[w];
      return flip ? glm::vec2(uv.x, from_other_origin(uv.y)) : uv;
    };
    const auto is_within = [&](WedgeId w) {
      const glm::vec2 uv = at(w);
      return uv.x >= 0.0F && uv.x <= 1.0F && uv.y >= 0.0F && uv.y <= 1.0F;
    };
    const std::vector<WedgeId>& wedges = primitive.wedges;
    const bool is_short = lattice_ && std::all_of(wedges.begin(), wedges.end(), is_within);
    ByteStream stream(is_short ? 4 : 8, wedges.size());
    for (const WedgeId w : wedges) {
      const glm::vec2 uv = at(w);
      is_short ? stream.add(unsigned_short(uv.x), unsigned_short(uv.y)) : stream.add(uv.x, uv.y);
    }
    return add_attribute(stream, is_short ? gltf::type_uint16 : gltf::type_float, "VEC2", is_short);
  }

  std::size_t add_positions(const GlbPrimitive& primitive) {
    ByteStream stream(12, primitive.wedges.size());
    glm::vec3 least(std::numeric_limits<float>::infinity()), most(-least);
    for (const WedgeId w : primitive.wedges) {
      const glm::vec3 from_origin(glm::dvec3(mesh_.positions[w]) - origin_);
      content_.box.take(glm::dvec3(from_origin) + origin_);
      const glm::vec3 position = y_up(from_origin);
      least = glm::min(least, position);
      most = glm::max(most, position);
      stream.add(position.x, position.y, position.z);
    }
    const std::size_t accessor = add_attribute(stream, gltf::type_float, "VEC3", false);
    set_bounds({least.x, least.y, least.z}, {most.x, most.y, most.z});
    return accessor;
  }

  // Adds lattice positions in glTF's axes: y counts downwards from the far end of the lattice.
  std::size_t add_lattice_positions(const GlbPrimitive& primitive) {
    ByteStream stream(8, primitive.wedges.size());
    glm::u16vec3 least(65535), most(0);
    for (const WedgeId w : primitive.wedges) {
      const glm::u16vec3 at = lattice_->at(mesh_.positions[w]);
      content_.box.take(lattice_->position(at));
      least = glm::min(least, at);
      most = glm::max(most, at);
      stream.add(at.x, at.z, static_cast<std::uint16_t>(lattice_->far_end().y - at.y), std::uint16_t{0});
    }
    const std::size_t accessor = add_attribute(stream, gltf::type_uint16, "VEC3", false);
    const int far_y = lattice_->far_end().y;
    set_bounds({least.x, least.z, far_y - most.y}, {most.x, most.z, far_y - least.y});
    return accessor;
  }

  void set_bounds(Json least, Json most) {
    document_.json()["accessors"].back()["min"] = std::move(least);
    document_.json()["accessors"].back()["max"] = std::move(most);
  }

  std::size_t add_normals(const GlbPrimitive& primitive) {
    ByteStream stream(12, primitive.wedges.size());
    for (const WedgeId w : primitive.wedges) {
      const glm::vec3 normal = y_up(mesh_.normals[w]);
      stream.add(normal.x, normal.y, normal.z);
    }
    return add_attribute(stream, gltf::type_float, "VEC3", false);
  }

  std::size_t add_short_normals(const GlbPrimitive& primitive) {
    ByteStream stream(4, primitive.wedges.size());
    for (const WedgeId w : primitive.wedges) {
      const glm::vec3 normal = y_up(mesh_.normals[w]);
      stream.add(signed_byte(normal.x), signed_byte(normal.y), signed_byte(normal.z), std::int8_t{0});
    }
    return add_attribute(stream, gltf::type_int8, "VEC3", true);
  }

  std::size_t add_colors(const GlbPrimitive& primitive) {
    ByteStream stream(8, primitive.wedges.size());
    for (const WedgeId w : primitive.wedges) {
      const glm::u8vec4& c = mesh_.colors[w];
      stream.add(linear_color(c.r), linear_color(c.g), linear_color(c.b), static_cast<std::uint16_t>(257 * c.a));
    }
    return add_attribute(stream, gltf::type_uint16, "VEC4", true);
  }

  // Adds them with padding: attributes take multiples of four bytes.
  std::size_t add_feature_ids(const GlbPrimitive& primitive) {
    ByteStream stream(4, primitive.wedges.size());
    for (const WedgeId w : primitive.wedges) stream.add(features_.row_of(w), std::uint16_t{0});
    return add_attribute(stream, gltf::type_uint16, "SCALAR", false);
  }

  std::size_t add_indices(const GlbPrimitive& primitive) {
    const bool is_short = primitive.has_short_indices();
    ByteStream stream(is_short ? 2 : 4, 3 * primitive.triangles.size());
    std::vector<std::uint32_t> indices;
    for (const Triangle& t : primitive.triangles)
      for (int k = 0; k < 3; ++k) {
        indices.push_back(t[k]);
        is_short ? stream.add(static_cast<std::uint16_t>(t[k])) : stream.add(t[k]);
      }
    return add_accessor(stream, is_compressed() ? encode_triangles(indices, primitive.wedges.size()) : std::string(),
                        is_short ? gltf::type_uint16 : gltf::type_uint32, "SCALAR", gltf::element_array_buffer);
  }

  std::size_t add_attribute(const ByteStream& stream, int component_type, const char* type, bool is_normalized) {
    const std::size_t accessor = add_accessor(stream, is_compressed() ? encode_vertices(stream) : std::string(),
                                              component_type, type, gltf::array_buffer);
    if (is_normalized) document_.json()["accessors"].back()["normalized"] = true;
    return accessor;
  }

  // Adds an accessor. `encoded` holds the bytes of a compressed tile; otherwise the stream is written unencoded.
  std::size_t add_accessor(const ByteStream& stream, const std::string& encoded, int component_type, const char* type,
                           int target) {
    const std::string& bytes = is_compressed() ? encoded : stream.bytes();
    const std::uint64_t offset = document_.reserve(bytes.size());
    buffer_ += bytes;
    buffer_.resize((buffer_.size() + 3) / 4 * 4, '\0');
    Json view = {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes.size()}};
    const bool is_attribute = target == gltf::array_buffer;
    if (is_compressed()) {
      view["byteStride"] = stream.stride();
      view["mode"] = is_attribute ? "ATTRIBUTES" : "TRIANGLES";
      view["count"] = stream.count();
      view = {{"buffer", 1},
              {"byteOffset", fallback_bytes_},
              {"byteLength", stream.bytes().size()},
              {"extensions", {{"EXT_meshopt_compression", std::move(view)}}}};
      fallback_bytes_ += (stream.bytes().size() + 3) / 4 * 4;
    }
    if (is_attribute) view["byteStride"] = stream.stride();
    view["target"] = target;
    Json& json = document_.json();
    json["bufferViews"].push_back(std::move(view));
    json["accessors"].push_back({{"bufferView", json["bufferViews"].size() - 1},
                                 {"componentType", component_type},
                                 {"count", stream.count()},
                                 {"type", type}});
    return json["accessors"].size() - 1;
  }

  const TriangleMesh& mesh_;
  const OwnImage& image_;
  const TileLook& look_;
  const TileFormat& format_;
  const FeatureTable features_;
  const glm::dvec3 origin_;             // of positions as floats
  std::optional<TileLattice> lattice_;  // of positions as integers
  GlbDocument document_;
  std::map<TextureId, TextureId> textures_;  // from ids of the HLOD, no_texture for the tile's own, to the document's
  std::string buffer_;                       // written to the file
  std::uint64_t fallback_bytes_ = 0;         // size of the buffer that decoders fill
  TileContent content_;
};

}  // namespace

TileContent encode_tile(const TileMesh& tile, const TileLook& look, const TileFormat& format,
                        const FileErrors& errors) {
  return TileEncoder(tile, look, format).run(errors);
}

}  // namespace occlod::tiles
