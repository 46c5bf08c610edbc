#include "mesh/gltf_buffers.h"

#include <bit>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>

#include "base/byte_order.h"

namespace occlod {
namespace {

using Json = nlohmann::json;

constexpr const char* extension = "EXT_meshopt_compression";
constexpr std::size_t header_bytes = 20;  // of a binary file and its first chunk

std::uint32_t word_at(std::string_view bytes, std::size_t offset) {
  return load<std::uint32_t>(bytes.data() + offset, std::endian::little);
}

bool is_binary(std::string_view bytes) { return bytes.substr(0, 4) == "glTF"; }

// Empty where nothing has to be replaced, or where the text is none.
std::string with_placeholders(std::string_view text, bool has_chunk) {
  if (text.find(extension) == std::string_view::npos) return {};
  Json json = Json::parse(text, nullptr, false);
  if (!json.is_object() || !json.contains("buffers") || !json["buffers"].is_array()) return {};
  bool changed = false;
  std::size_t index = 0;
  for (Json& buffer : json["buffers"]) {
    const bool is_chunk = has_chunk && index++ == 0;
    if (is_chunk || !buffer.is_object() || buffer.contains("uri")) continue;
    buffer["byteLength"] = 1;
    buffer["uri"] = "data:application/octet-stream;base64,AA==";
    changed = true;
  }
  return changed ? json.dump(-1, ' ', false, Json::error_handler_t::replace) : std::string();
}

void append_word(std::string& bytes, std::size_t value) {
  for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(value >> shift & 0xffU);
}

}  // namespace

std::string_view gltf_text(std::string_view bytes) {
  if (!is_binary(bytes)) return bytes;
  if (bytes.size() < header_bytes || word_at(bytes, 12) > bytes.size() - header_bytes) return {};
  return bytes.substr(header_bytes, word_at(bytes, 12));
}

std::string_view with_missing_buffers(std::string_view bytes, std::string& patched) {
  if (!is_binary(bytes)) {
    patched = with_placeholders(bytes, false);
    return patched.empty() ? bytes : patched;
  }
  const std::size_t chunk = gltf_text(bytes).size();
  std::string text = with_placeholders(gltf_text(bytes), true);
  if (text.empty()) return bytes;
  text.resize((text.size() + 3) / 4 * 4, ' ');
  patched = bytes.substr(0, 8);
  append_word(patched, bytes.size() - chunk + text.size());
  append_word(patched, text.size());
  patched += bytes.substr(16, 4);
  patched += text;
  patched += bytes.substr(header_bytes + chunk);
  return patched;
}

}  // namespace occlod
