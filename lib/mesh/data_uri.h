// URIs that hold data themselves (RFC 2397), as glTF has them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace occlod {

// The parts of a data URI. The data are still encoded.
struct DataUri {
  std::string media_type;  // in lower case, without parameters; may be empty
  bool is_base64 = false;
  std::string_view data;
};

// Returns nothing for any other URI.
[[nodiscard]] std::optional<DataUri> parse_data_uri(std::string_view uri);

// Decodes base64 with or without padding, also with the letters for URLs. A blank counts as '+', which some decoders of
// URIs turn into one. Returns nothing for any other text. O(n).
[[nodiscard]] std::optional<std::vector<std::uint8_t>> decode_base64(std::string_view text);

}  // namespace occlod
