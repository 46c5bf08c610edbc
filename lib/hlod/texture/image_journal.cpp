#include "hlod/texture/image_journal.h"

#include <xxhash.h>

#include <algorithm>
#include <array>
#include <memory>
#include <span>
#include <string_view>

#include "base/memory.h"
#include "hlod/build/build_bytes.h"
#include "hlod/hlod_builder_id.h"
#include "hlod/store/hlod_data.h"
#include "hlod/store/ohlod.h"
#include "mesh/image_files.h"
#include "occlod/mesh.h"

namespace occlod::hlod {
namespace {

struct Header {
  std::array<char, 8> magic{'O', 'C', 'C', 'L', 'O', 'D', 'I', 'J'};
  std::uint64_t key = 0;  // hash of all that the images depend on, and of the sources that make them
};
static_assert(sizeof(Header) == 16);

// Hashes what decides the images of all nodes.
std::uint64_t key_of(const Hlod& hlod, const std::filesystem::path& image_folder) {
  const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(), &XXH3_freeState);
  XXH3_64bits_reset(state.get());
  const auto add = [&](const auto& values) {
    const std::span bytes = std::as_bytes(std::span(values));
    const std::size_t size = bytes.size();
    XXH3_64bits_update(state.get(), &size, sizeof(size));
    XXH3_64bits_update(state.get(), bytes.data(), size);
  };
  add(std::string_view(hlod_builder_id));
  const HlodView& view = hlod.data();
  add(view.nodes);
  for (NodeId n = 0; n < hlod.node_count(); ++n) {
    make_room();
    hlod.require(n);
    add(std::array{ohlod::digest_of_mesh(view, n)});
  }
  for (const Material& material : view.materials) add(material.textures());
  for (const Texture& texture : view.textures) {
    const auto image = find_image(texture, image_folder);
    add(texture.file);
    add(std::array{texture.wrap_s, texture.wrap_t, static_cast<TextureWrap>(view.texture_origin)});
    add(image ? std::span<const std::uint8_t>(*image) : std::span<const std::uint8_t>());
  }
  return XXH3_64bits_digest(state.get());
}

}  // namespace

ImageJournal::ImageJournal(const std::filesystem::path& path, const Hlod& hlod,
                           const std::filesystem::path& image_folder)
    : records_(path) {
  const Header wanted{.key = key_of(hlod, image_folder)};
  Header found{.magic = {}};
  const std::size_t size = records_.read_header(writable_bytes_of(found));
  if (!std::equal(found.magic.begin(), found.magic.begin() + std::min<std::size_t>(size, found.magic.size()),
                  wanted.magic.begin()))
    records_.refuse("", "is not a journal of images", "move it away");
  if (size == sizeof(found) && found.key == wanted.key)
    records_.go_to({sizeof(Header), wanted.key});
  else
    records_.restart(bytes_of(wanted), wanted.key);
}

bool ImageJournal::take(ImagePart& part) {
  if (all_taken_) return false;
  if (!records_.take(bytes_)) {
    all_taken_ = true;
    records_.cut_rest();
    return false;
  }
  std::span<const std::byte> left = bytes_;
  get_bytes(left, writable_bytes_of(part.texel_size));
  part.bytes.assign(left.begin(), left.end());
  return true;
}

void ImageJournal::append(const ImagePart& part) {
  bytes_.resize(sizeof(JournalRecords::Head));
  put_bytes(bytes_, bytes_of(part.texel_size));
  put_bytes(bytes_, part.bytes);
  records_.append(bytes_);
}

}  // namespace occlod::hlod
