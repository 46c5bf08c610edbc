// Writes the tileset of an HLOD: images, contents and JSON files, in a folder or archive that it may replace.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <glm/mat4x4.hpp>
#include <iterator>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "base/atomic_file.h"
#include "base/file_input.h"
#include "base/option_checker.h"
#include "base/strict_json.h"
#include "base/threads.h"
#include "hlod/texture/own_images.h"
#include "hlod/texture/source_textures.h"
#include "hlod/texture/tile_texture.h"
#include "hlod/tiles/encode_tile.h"
#include "hlod/tiles/tile_mesh.h"
#include "hlod/tiles/tile_tree.h"
#include "hlod/tiles/tileset_files.h"
#include "mesh/image_codec.h"
#include "mesh/image_files.h"
#include "occlod/base.h"
#include "occlod/hlod.h"
#include "occlod/tiles.h"

namespace occlod::tiles {
namespace {

namespace fs = std::filesystem;

// Returns, by material, whether tiles show it by images of their own: those that the nodes have, or those that are
// divided among tiles.
std::vector<std::uint8_t> own_materials(const hlod::HlodView& hlod, const SourceTextures& sources) {
  std::vector<std::uint8_t> is_own(hlod.image_materials.begin(), hlod.image_materials.end());
  is_own.resize(hlod.materials.size(), 0);
  for (std::size_t m = 0; m < is_own.size(); ++m)
    if (sources.image_of(static_cast<MaterialId>(m)) != no_id) is_own[m] = 1;
  return is_own;
}

// Returns, by texture, whether a material shows it that shows no image of the tile's own.
std::vector<std::uint8_t> shared_textures(const hlod::HlodView& hlod, std::span<const std::uint8_t> is_own) {
  std::vector<std::uint8_t> is_shared(hlod.textures.size(), 0);
  for (std::size_t m = 0; m < hlod.materials.size(); ++m) {
    if (is_own[m] != 0) continue;
    for (const TextureId id : hlod.materials[m].textures())
      if (id != no_texture) is_shared[id] = 1;
  }
  return is_shared;
}

// Writes each image once, in the folder textures/, for all contents to share, but those that are divided among them.
// Leaves out images that are missing or in a format that glTF lacks, whatever their names, and names them in
// `left_out`. File names are relative to `image_folder`. O(bytes).
[[nodiscard]] TileLook write_images(TilesetFiles& files, const hlod::HlodView& hlod,
                                    std::span<const std::uint8_t> is_own, const fs::path& image_folder,
                                    std::vector<std::string>& left_out) {
  TileLook look{hlod.materials, hlod.textures, {}, hlod.texture_origin, hlod.features.names};
  std::map<std::string, std::string> written;  // from file names to URIs
  const std::vector<std::uint8_t> is_shared = shared_textures(hlod, is_own);
  for (const Texture& texture : hlod.textures) {
    std::string& uri = look.images.emplace_back();
    if (is_shared[look.images.size() - 1] == 0) continue;
    const bool is_file = texture.bytes.empty();
    if (const auto known = written.find(texture.file); is_file && known != written.end()) {
      uri = known->second;
      continue;
    }
    const std::size_t number = look.images.size() - 1;
    const auto bytes = find_image(texture, image_folder);
    const std::string type = bytes ? image_type(*bytes) : "";
    if (!gltf_image_extension(type)) {
      left_out.push_back(is_file ? texture.file : fmt::format("image {}", number));
    } else {
      const std::string name = fmt::format("textures/{}{}", number, image_extension(type));
      files.write(name, std::string(bytes->begin(), bytes->end()));
      uri = "../../" + name;
    }
    if (is_file) written[texture.file] = uri;
  }
  return look;
}

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& folder, std::string problem, std::string remedy) {
  throw Error({folder.string(), "", std::move(problem), std::move(remedy)});
}

// Reads what a tileset.json says of files: those that tiles name, the images that it lists, and who wrote it.
class NamesInTileset final : public nlohmann::json_sax<nlohmann::json> {
 public:
  std::vector<std::string> uris, images;
  std::string generator;

  bool string(std::string& text) override {
    if (path_.empty()) return true;
    if (path_.back() == "uri") uris.push_back(text);
    if (path_ == Path{"asset", "extras", "generator"}) generator = text;
    if (path_ == Path{"asset", "extras", "images", ""}) images.push_back(text);
    return true;
  }
  bool key(std::string& name) override {
    path_.back() = name;
    return true;
  }
  bool start_object(std::size_t /*elements*/) override { return begin(); }
  bool start_array(std::size_t /*elements*/) override { return begin(); }
  bool end_object() override { return end(); }
  bool end_array() override { return end(); }
  bool null() override { return true; }
  bool boolean(bool /*value*/) override { return true; }
  bool number_integer(number_integer_t /*value*/) override { return true; }
  bool number_unsigned(number_unsigned_t /*value*/) override { return true; }
  bool number_float(number_float_t /*value*/, const std::string& /*text*/) override { return true; }
  bool binary(binary_t& /*bytes*/) override { return true; }
  bool parse_error(std::size_t /*at*/, const std::string& /*token*/, const nlohmann::json::exception&) override {
    return false;
  }

 private:
  using Path = std::vector<std::string>;

  bool begin() {
    path_.emplace_back();
    return true;
  }
  bool end() {
    path_.pop_back();
    return true;
  }

  Path path_;  // the keys of the values in the open objects; empty for arrays
};

// Returns the names of all files that write_tileset() has written into a folder, relative to it; none if the folder is
// not its work.
std::set<std::string> exported_files(const fs::path& folder) {
  std::set<std::string> files{"tileset.json"};
  std::vector<std::string> unread{"tileset.json"};
  while (!unread.empty()) {
    const std::string name = std::move(unread.back());
    unread.pop_back();
    std::error_code unknown;
    if (!fs::is_regular_file(folder / name, unknown)) {
      if (name == "tileset.json") return {};
      continue;
    }
    NamesInTileset names;
    const LargeVector<std::byte> text = read_whole(folder / name);
    const char* const first = reinterpret_cast<const char*>(text.data());
    const bool is_json = nlohmann::json::sax_parse(first, first + text.size(), &names);
    if (name == "tileset.json" && (!is_json || !names.generator.starts_with("occlod "))) return {};
    for (std::string& uri : names.uris)
      if (files.insert(uri).second && uri.ends_with(".json") && uri.find('/') == std::string::npos)
        unread.push_back(std::move(uri));
    files.insert(names.images.begin(), names.images.end());
  }
  return files;
}

// Returns the name, relative to the folder, of the first file or folder in it, in the order of names, that is not among
// the files or a folder of one. Links are not followed. Empty if there is none.
std::string first_other(const fs::path& folder, const std::set<std::string>& files) {
  std::set<std::string> folders;
  for (const std::string& file : files)
    for (fs::path above = fs::path(file).parent_path(); !above.empty() && folders.insert(above.string()).second;)
      above = above.parent_path();
  std::string first;
  std::error_code error;
  for (fs::recursive_directory_iterator entry(folder, error); !error && entry != fs::recursive_directory_iterator();
       entry.increment(error)) {
    const fs::file_type type = entry->symlink_status(error).type();
    const std::string name = entry->path().lexically_relative(folder).generic_string();
    const bool is_ours = type == fs::file_type::directory ? folders.contains(name)
                                                          : type == fs::file_type::regular && files.contains(name);
    if (!is_ours && (first.empty() || name < first)) first = name;
  }
  if (error) fail(folder, fmt::format("cannot be read: {}", error.message()), "check its permissions");
  return first;
}

}  // namespace

hlod::HlodBuildOptions build_options() {
  hlod::HlodBuildOptions options;
  options.grouping = hlod::Grouping::nested;
  options.borders = hlod::Borders::free;
  options.error_bound = ErrorBound::measured;
  return options;
}

namespace {

void check_archive(const fs::path& file, bool replace) {
  AtomicFile::check(file);
  std::error_code unknown;
  if (!replace && fs::exists(file, unknown))
    fail(file, "is there already", "choose a new name, or replace it with --replace");
}

void check_folder(const fs::path& folder, bool replace) {
  AtomicFolder::check(folder);
  std::error_code error;
  if (!fs::exists(folder, error)) return;
  const bool is_empty = fs::is_empty(folder, error);
  if (error) fail(folder, fmt::format("cannot be read: {}", error.message()), "check its permissions");
  if (is_empty) return;
  const std::set<std::string> files = exported_files(folder);
  if (files.empty()) fail(folder, "holds a tileset.json that occlod has not written, or none", "choose a new folder");
  if (const std::string other = first_other(folder, files); !other.empty())
    fail(folder, fmt::format("holds {}, which is no part of the tileset of occlod there", other),
         "move it elsewhere, or choose a new folder");
  if (!replace) fail(folder, "holds a tileset already", "choose a new folder, or replace it with --replace");
}

}  // namespace

void check_tileset_output(const fs::path& path, bool replace) {
  is_archive(path) ? check_archive(path, replace) : check_folder(path, replace);
}

void check_tileset_options(const TilesetOptions& options) {
  const OptionChecker checker("tileset options");
  if (options.quantise_bits && *options.quantise_bits != 0)
    checker.in_range("quantise_bits", *options.quantise_bits, 8, 16);
  checker.in_range("threads", options.threads, 0, 1024);
  if (options.origin) {
    checker.in_range("longitude_deg", options.origin->longitude_deg, -180.0, 180.0);
    checker.in_range("latitude_deg", options.origin->latitude_deg, -90.0, 90.0);
    checker.in_range("height_m", options.origin->height_m, -1e7, 1e9);
  }
  if (options.compression == Compression::meshopt && !has_meshopt())
    throw Error({"tileset options", "", "this build of occlod has no EXT_meshopt_compression",
                 "build it with meshoptimizer, or write without compression"});
}

namespace {

constexpr double least_texels = 1024.0;  // of a tile's image, to be worth a tile of its own
constexpr std::size_t max_levels = 100;  // files may be nested as deeply

void check(const hlod::Hlod& hlod) {
  const hlod::HlodView& view = hlod.data();
  if (view.nodes.empty()) throw Error({"HLOD", "", "has no nodes", "build it from a mesh with triangles"});
  const bool is_tree =
      view.grouping == hlod::Grouping::nested &&
      std::all_of(view.nodes.begin(), view.nodes.end(), [](const hlod::Node& n) { return n.patches <= 1; });
  if (!is_tree)
    throw Error({"HLOD", "", "has nodes with several parents, and tiles form a tree",
                 "build it with nested groups: --grouping nested --borders free"});
  if (view.levels.size() > max_levels) throw Error({"HLOD", "", "has more than 100 levels", "build it again"});
}

// Returns the transform of the root, from positions of the HLOD to the tileset.
std::optional<glm::dmat4> transform_of(const TilesetOptions& options, UpAxis up, const glm::dvec3& origin) {
  if (!options.origin && up == UpAxis::z && origin == glm::dvec3(0.0)) return std::nullopt;
  glm::dmat4 transform(1.0);
  if (options.origin) transform = east_north_up(*options.origin);
  if (up == UpAxis::y) transform = {transform[0], transform[2], -transform[1], transform[3]};
  return positions_to_world(transform, origin);
}

class TilesetWriter {
 public:
  TilesetWriter(const std::filesystem::path& path, const hlod::Hlod& hlod, const TilesetOptions& options,
                std::uint32_t tiles_per_file)
      : errors_(path),
        path_(path),
        files_(make_tileset_files(path)),
        hlod_(hlod),
        options_(options),
        tiles_per_file_(tiles_per_file),
        tree_(hlod) {
    const int usual_bits = options.compression == Compression::none ? 0 : 14;
    format_ = {options.compression, options.quantise_bits.value_or(usual_bits)};
    needs_borders_ = !hlod.data().has_normals || options.skirts;
    const std::size_t leaves = hlod.data().levels[0].node_count;
    has_node_images_ = !hlod.data().node_images.empty();
    const bool divides_images = !has_node_images_ && !hlod.data().textures.empty();
    steps_ = hlod.node_count() + (needs_borders_ ? leaves : 0) + (divides_images ? 2 * leaves : 0);
    threads_ = thread_count(options.threads);
  }

  TilesetCounts run() && {
    if (needs_borders_) borders_ = BorderVertices(hlod_, [this] { step(); });
    if (!has_node_images_) sources_ = SourceTextures(hlod_, options_.image_folder, threads_, [this] { step(); });
    count_sources();
    look_ = write_images(*files_, hlod_.data(), own_materials(hlod_.data(), sources_), options_.image_folder,
                         counts_.images_left_out);
    std::vector<WrittenTile> tiles(std::min<std::size_t>(hlod_.node_count(), std::size_t{8} * threads_));
    for (std::size_t first = 0; first < hlod_.node_count(); first += tiles.size()) {
      const std::size_t count = std::min(tiles.size(), hlod_.node_count() - first);
      for_each_task(count, threads_,
                    [&](std::size_t i) { tiles[i] = made_tile(static_cast<hlod::NodeId>(first + i)); });
      for (std::size_t i = 0; i < count; ++i) {
        step();
        write(static_cast<hlod::NodeId>(first + i), tiles[i]);
      }
    }
    tree_.complete(TileError::guaranteed, tiles_per_file_);
    counts_.tileset_files = write_tileset_json(
        *files_, tree_, transform_of(options_, options_.up.value_or(hlod_.data().up), hlod_.data().origin), images());
    check_tileset_output(path_, options_.replace);  // again: what came meanwhile is not removed
    counts_.bytes = files_->commit();
    return counts_;
  }

 private:
  // Returns the names of the image files, relative to the folder.
  [[nodiscard]] std::set<std::string> images() const {
    std::set<std::string> names;
    for (const std::string& uri : look_.images)
      if (!uri.empty()) names.insert(uri.substr(uri.find("textures/")));
    return names;
  }

  void step() {
    if (options_.progress) options_.progress(static_cast<double>(done_) / static_cast<double>(steps_));
    ++done_;
  }

  // The tiles of a node, the finest first, with what is counted of them; none where everything has vanished.
  struct WrittenTile {
    std::vector<TileContent> contents;
    std::vector<double> texel_sizes;  // by content, 0 for one that has its source's
    TilesetCounts counts;
  };

  void count_sources() {
    counts_.images_shared = sources_.shared();
    for (const SourceImage& image : sources_.images()) counts_.source_texels += image.levels[0].pixels.size();
    texture_format_ = options_.texture_format.value_or(sources_.usual_format());
    if (!has_node_images_) return;
    const hlod::HlodView& view = hlod_.data();
    for (std::size_t t = 0; t < view.textures.size(); ++t)
      for (std::size_t m = 0; m < view.materials.size(); ++m)
        if (view.materials[m].texture == t && view.image_materials[m] == 0) {
          counts_.images_shared.push_back(
              {name_of_image(view.textures, static_cast<TextureId>(t)), "nodes of the .ohlod file do not have it"});
          break;
        }
  }

  // Any number of threads may call this.
  [[nodiscard]] WrittenTile made_tile(hlod::NodeId n) const {
    WrittenTile made;
    if (hlod_.node(n).triangles == 0) return made;
    hlod_.require(n);
    TileMesh tile = tile_mesh(hlod_, n, borders_);
    if (tile.mesh.triangles.empty()) return made;
    if (has_node_images_) {
      add_with_image_of_node(n, std::move(tile), made);
      return made;
    }
    const double mean = sources_.images().empty() ? 0.0 : shown_texels(tile.mesh, sources_).mean_size;
    if (mean == 0.0) {
      add_content(n, std::move(tile), 0.0, made);
      return made;
    }
    const double texel_size = hlod::texel_size_of(hlod_.node(n), hlod_.node(n).guaranteed_error, mean);
    add_with_new_image(n, tile, sources_, texel_size, texture_format_, made);
    const auto texels = static_cast<double>(made.counts.texels);
    for (const double coarser : coarser_sizes(n, std::max(texel_size, mean), texels))
      add_with_new_image(n, tile, sources_, coarser, texture_format_, made);
    return made;
  }

  // Returns the sizes of texels of the node's coarser images, whose finest one has so many of such a size.
  [[nodiscard]] std::vector<double> coarser_sizes(hlod::NodeId n, double size, double texels) const {
    const hlod::NodeId parent = parent_of(hlod_, n);
    constexpr double by = hlod::coarser_by, fewer = by * by;
    std::vector<double> sizes;
    for (;;) {
      size *= by;
      texels /= fewer;
      if (parent == no_id || texels < least_texels || size * std::numbers::sqrt2 >= hlod_.node(parent).guaranteed_error)
        return sizes;
      sizes.push_back(size);
    }
  }

  // Adds the tiles of a node that may have an image in the HLOD: they need no image of the input.
  void add_with_image_of_node(hlod::NodeId n, TileMesh tile, WrittenTile& made) const {
    const hlod::HlodView& view = hlod_.data();
    const std::span<const std::uint8_t> image = hlod_.mesh(n).image;
    if (image.empty()) return add_content(n, std::move(tile), 0.0, made);
    const std::string name = fmt::format("image of node {}", n);
    const ImageSize size = size_of_image(image, name);
    const double texels = static_cast<double>(size.width) * size.height, texel_size = view.node_images[n].texel_size;
    SourceTextures source(size, view.image_materials, view.texture_origin);
    const ShownTexels shown = shown_texels(tile.mesh, source);
    made.counts.texels += static_cast<std::uint64_t>(texels);
    made.counts.charts += shown.charts;
    TileMesh finest = tile;
    finest.image.bytes = in_format(image, name);
    finest.image.is_shown_by.assign(view.image_materials.begin(), view.image_materials.end());
    made.counts.texture_bytes += finest.image.bytes.size();
    add_content(n, std::move(finest), texel_size, made);
    const std::vector<double> sizes = coarser_sizes(n, std::max(texel_size, shown.mean_size), texels);
    if (sizes.empty() || shown.mean_size == 0.0) return;
    source.show(decode_texels(image, name), tile.mesh);
    const TextureFormat format = options_.texture_format.value_or(format_of(image));
    for (const double coarser : sizes) add_with_new_image(n, tile, source, coarser, format, made);
  }

  // Returns an encoded image in the format that is asked for, if it is not that.
  [[nodiscard]] std::vector<std::uint8_t> in_format(std::span<const std::uint8_t> image,
                                                    const std::string& name) const {
    const TextureFormat is = format_of(image);
    if (options_.texture_format.value_or(is) == is) return {image.begin(), image.end()};
    const Texels texels = decode_texels(image, name);
    TileImage again;
    again.width = texels.width;
    again.height = texels.height;
    again.pixels.assign(texels.pixels.begin(), texels.pixels.end());
    again.is_free.resize(again.pixels.size(), 0);
    return encode(std::move(again), *options_.texture_format);
  }

  [[nodiscard]] static TextureFormat format_of(std::span<const std::uint8_t> image) {
    return image_type(image) == "image/jpeg" ? TextureFormat::jpeg : TextureFormat::png;
  }

  // Adds a tile of the node with an image of what it shows, with texels of that size.
  void add_with_new_image(hlod::NodeId n, TileMesh tile, const SourceTextures& sources, double texel_size,
                          TextureFormat format, WrittenTile& made) const {
    TileImage image = make_tile_image(tile.mesh, sources, texel_size);
    const double largest = image.texel_size;
    if (image.width > 0) {
      made.counts.texels += image.pixels.size();
      made.counts.charts += image.charts;
      tile.image.is_shown_by = std::move(image.is_of_tile);
      tile.image.bytes = encode(std::move(image), format);
      made.counts.texture_bytes += tile.image.bytes.size();
    }
    add_content(n, std::move(tile), largest, made);
  }

  // Adds a tile of the node; `texel_size` is that of the largest texel that is larger than its source's.
  void add_content(hlod::NodeId n, TileMesh tile, double texel_size, WrittenTile& made) const {
    made.texel_sizes.push_back(texel_size);
    const hlod::NodeId parent = parent_of(hlod_, n);
    if (options_.skirts && parent != no_id) add_skirts(tile, hlod_.node(parent).guaranteed_error, borders_);
    made.contents.push_back(encode_tile(tile, look_, format_, errors_));
    made.counts.triangles += tile.mesh.triangles.size() - tile.skirt_triangles;
    made.counts.skirt_triangles += tile.skirt_triangles;
  }

  void write(hlod::NodeId n, const WrittenTile& made) {
    if (made.contents.empty()) return;
    for (std::size_t i = 0; i < made.contents.size(); ++i) {
      files_->write(content_name(n, i), made.contents[i].bytes);
      counts_.content_bytes += made.contents[i].bytes.size();
    }
    tree_[n].content_box = made.contents[0].box;
    tree_[n].texture_error = made.texel_sizes[0];
    tree_[n].coarser.assign(made.texel_sizes.begin() + 1, made.texel_sizes.end());
    counts_.tiles += made.contents.size();
    counts_.triangles += made.counts.triangles;
    counts_.skirt_triangles += made.counts.skirt_triangles;
    counts_.texels += made.counts.texels;
    counts_.texture_bytes += made.counts.texture_bytes;
    counts_.charts += made.counts.charts;
  }

  FileErrors errors_;
  fs::path path_;
  std::unique_ptr<TilesetFiles> files_;
  const hlod::Hlod& hlod_;
  const TilesetOptions& options_;
  std::uint32_t tiles_per_file_;
  TileFormat format_;
  bool needs_borders_ = false;
  bool has_node_images_ = false;  // tiles take those, and no images of the input
  BorderVertices borders_;
  SourceTextures sources_;
  TextureFormat texture_format_ = TextureFormat::png;
  unsigned threads_ = 1;
  TileLook look_;
  TileTree tree_;
  TilesetCounts counts_;
  std::size_t steps_ = 0;  // total, for progress
  std::size_t done_ = 0;
};

}  // namespace

TilesetCounts write_tileset(const std::filesystem::path& path, const hlod::Hlod& hlod, const TilesetOptions& options) {
  return write_tileset(path, hlod, options, usual_tiles_per_file);
}

TilesetCounts write_tileset(const std::filesystem::path& path, const hlod::Hlod& hlod, const TilesetOptions& options,
                            std::uint32_t tiles_per_file) {
  check_tileset_options(options);
  check(hlod);
  check_tileset_output(path, options.replace);
  return TilesetWriter(path, hlod, options, tiles_per_file).run();
}

}  // namespace occlod::tiles
