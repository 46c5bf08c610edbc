#include "mesh/glb_look.h"

#include <fmt/format.h>

#include <utility>

#include "base/file_input.h"
#include "mesh/image_files.h"
#include "mesh/materials.h"

namespace occlod {

GlbLook::GlbLook(const TriangleMesh& mesh, const MeshOutput& output) : mesh_(mesh) {
  const std::vector<Texture>& all = mesh_.textures;
  new_ids_.resize(all.size(), no_texture);
  if (mesh_.texture_coordinates.empty()) {
    if (!all.empty()) output.notes.emplace_back("without texture coordinates there are no textures in a GLB file");
    return;
  }
  for (std::size_t t = 0; t < all.size(); ++t) {
    const auto id = static_cast<TextureId>(t);
    const std::optional<std::size_t> image = image_of(id, output);
    if (!image) continue;
    new_ids_[t] = static_cast<TextureId>(textures_.size());
    textures_.emplace_back(id, *image);
  }
}

// Finds or adds the image of a texture. Returns nothing when it is left out.
std::optional<std::size_t> GlbLook::image_of(TextureId t, const MeshOutput& output) {
  const Texture& texture = mesh_.textures[t];
  for (std::size_t i = 0; i < images_.size(); ++i) {
    const Texture& other = mesh_.textures[images_[i].texture];
    if (other.file == texture.file && other.bytes == texture.bytes) return i;
  }
  Image image{t, {}, {}};
  if (texture.bytes.empty()) {
    image.file_bytes = read_image(texture, output.image_folder).value_or(ImageBytes());
    image.type = image_type(image.file_bytes, texture.file);
    if (image.file_bytes.empty()) note_missing(texture.file, output);
  } else {
    image.type = image_type(texture);
  }
  // A file that is not there may be of any format.
  const bool may_be_any = image.bytes_of(texture).empty() && image.type == "application/octet-stream";
  if (!gltf_image_extension(image.type) && !may_be_any) {
    output.notes.push_back(
        fmt::format("the image {} is left out: glTF has PNG, JPEG, WebP, KTX2, DDS and AVIF",
                    texture.file.empty() ? fmt::format("of texture {}", t) : in_quotes(texture.file)));
    return std::nullopt;
  }
  images_.push_back(std::move(image));
  return images_.size() - 1;
}

void GlbLook::describe(GlbDocument& document) const {
  for (Material material : mesh_.materials) {
    change_textures(material, [&](TextureId id) { return new_ids_[id]; });
    document.add_material(material);
  }
  for (const Image& image : images_) {
    const Texture& texture = mesh_.textures[image.texture];
    const std::size_t bytes = image.bytes_of(texture).size();
    if (bytes == 0)
      document.add_image({{"uri", uri_of(texture.file)}});
    else
      document.add_image({{"bufferView", document.add_view(bytes, 0)}, {"mimeType", image.type}});
  }
  for (const auto& [texture, image] : textures_)
    document.add_texture(mesh_.textures[texture], image, images_[image].type);
}

void GlbLook::write(ChunkedWriter& out) const {
  for (const Image& image : images_) {
    const std::span<const std::uint8_t> bytes = image.bytes_of(mesh_.textures[image.texture]);
    for (const std::uint8_t byte : bytes) out.numbers(byte);
    for (std::size_t i = bytes.size(); i % 4 != 0; ++i) out.numbers(std::uint8_t{0});
  }
}

}  // namespace occlod
