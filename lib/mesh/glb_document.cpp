#include "mesh/glb_document.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

namespace occlod {
namespace {

int wrap_mode(TextureWrap wrap) {
  return wrap == TextureWrap::repeat ? 10497 : wrap == TextureWrap::clamp ? 33071 : 33648;
}

void append_number(std::string& bytes, std::uint64_t number) {
  for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>((number >> shift) & 0xffU);
}

}  // namespace

GlbDocument::GlbDocument() {
  json_["asset"] = {{"version", "2.0"}, {"generator", "occlod"}};
  json_["scene"] = 0;
  json_["scenes"][0]["nodes"][0] = 0;
  json_["nodes"][0]["mesh"] = 0;
  json_["meshes"][0]["primitives"] = Json::array();
}

std::uint64_t GlbDocument::reserve(std::uint64_t bytes) {
  const std::uint64_t offset = bytes_;
  bytes_ += (bytes + 3) / 4 * 4;
  return offset;
}

std::size_t GlbDocument::add_view(std::uint64_t bytes, int target) {
  Json view = {{"buffer", 0}, {"byteOffset", reserve(bytes)}, {"byteLength", bytes}};
  if (target != 0) view["target"] = target;
  json_["bufferViews"].push_back(std::move(view));
  return json_["bufferViews"].size() - 1;
}

std::size_t GlbDocument::add_accessor(std::uint64_t bytes, int target, int component_type, std::size_t count,
                                      const char* type) {
  const std::size_t view = add_view(bytes, target);
  json_["accessors"].push_back(
      {{"bufferView", view}, {"componentType", component_type}, {"count", count}, {"type", type}});
  return json_["accessors"].size() - 1;
}

void GlbDocument::add_material(const Material& material) {
  const glm::vec4& c = material.base_color;
  Json look = {{"baseColorFactor", {c.r, c.g, c.b, c.a}}, {"metallicFactor", 0}};
  if (material.texture != no_texture) look["baseColorTexture"] = {{"index", material.texture}};
  Json described;
  if (!material.name.empty()) described["name"] = material.name;
  described["pbrMetallicRoughness"] = std::move(look);
  if (c.a < 1.0F) described["alphaMode"] = "BLEND";
  json_["materials"].push_back(std::move(described));
}

void GlbDocument::add_texture(const Texture& texture, Json image) {
  const std::size_t index = json_["images"].size();
  json_["images"].push_back(std::move(image));
  json_["samplers"].push_back({{"wrapS", wrap_mode(texture.wrap_s)}, {"wrapT", wrap_mode(texture.wrap_t)}});
  json_["textures"].push_back({{"source", index}, {"sampler", index}});
}

std::string GlbDocument::head(const FileErrors& errors) {
  json_["buffers"][0]["byteLength"] = bytes_;
  std::string text = json_.dump(-1, ' ', false, Json::error_handler_t::replace);
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const std::uint64_t whole = 28 + text.size() + bytes_;
  if (whole > std::numeric_limits<std::uint32_t>::max())
    errors.fail("", "would be larger than the 4 GiB that a GLB file can have", "write .ply");
  std::string head = "glTF";
  append_number(head, 2);
  append_number(head, whole);
  append_number(head, text.size());
  head += "JSON";
  head += text;
  append_number(head, bytes_);
  head += std::string_view("BIN\0", 4);
  return head;
}

std::string uri_of(const std::string& file) {
  constexpr std::string_view plain = "-._~/!$&'()*+,;=:@";
  std::string uri;
  for (const char c : file) {
    const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (is_letter || plain.find(c) != std::string_view::npos)
      uri += c;
    else
      uri += fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return uri;
}

std::uint16_t linear_color(std::uint8_t encoded) {
  return static_cast<std::uint16_t>(std::lround(65535.0 * srgb_to_linear(encoded / 255.0)));
}

}  // namespace occlod
