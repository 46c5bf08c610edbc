#include "mesh/section_file.h"

#include <fmt/format.h>
#include <xxhash.h>
#include <zstd.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <memory>
#include <new>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "base/atomic_file.h"
#include "base/strict_json.h"
#include "base/text.h"
#include "occlod/base.h"

namespace occlod::olod {
namespace {

constexpr std::size_t packed_run = std::size_t{4} << 20U;  // raw bytes per frame
constexpr int level = 3;  // higher levels compress a few percent better and take several times as long

// Returns the size of a run of whole elements, so that frames do not depend on each other.
std::size_t run_of(std::size_t element_bytes) { return packed_run / element_bytes * element_bytes; }

}  // namespace

void separate(std::span<const std::byte> elements, std::size_t element_bytes, std::span<std::byte> planes) {
  const std::size_t count = elements.size() / element_bytes;
  for (std::size_t k = 0; k < element_bytes; ++k)
    for (std::size_t i = 0; i < count; ++i) planes[k * count + i] = elements[i * element_bytes + k];
  std::copy(elements.begin() + static_cast<std::ptrdiff_t>(count * element_bytes), elements.end(),
            planes.begin() + static_cast<std::ptrdiff_t>(count * element_bytes));
}

void join(std::span<const std::byte> planes, std::size_t element_bytes, std::span<std::byte> elements) {
  const std::size_t count = planes.size() / element_bytes;
  for (std::size_t k = 0; k < element_bytes; ++k)
    for (std::size_t i = 0; i < count; ++i) elements[i * element_bytes + k] = planes[k * count + i];
  std::copy(planes.begin() + static_cast<std::ptrdiff_t>(count * element_bytes), planes.end(),
            elements.begin() + static_cast<std::ptrdiff_t>(count * element_bytes));
}

std::vector<std::byte> pack(std::span<const std::byte> raw, std::size_t element_bytes) {
  const std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> context(ZSTD_createCCtx(), &ZSTD_freeCCtx);
  if (!context) throw std::bad_alloc();
  std::vector<std::byte> packed;
  std::vector<std::byte> planes(std::min(raw.size(), run_of(element_bytes)));
  while (!raw.empty()) {
    const auto run = raw.first(std::min(raw.size(), planes.size()));
    separate(run, element_bytes, planes);
    const std::size_t before = packed.size();
    packed.resize(before + ZSTD_compressBound(run.size()));
    const std::size_t size = ZSTD_compressCCtx(context.get(), packed.data() + before, packed.size() - before,
                                               planes.data(), run.size(), level);
    if (ZSTD_isError(size) != 0) throw std::bad_alloc();  // the only way to fail with enough room
    packed.resize(before + size);
    raw = raw.subspan(run.size());
  }
  return packed;
}

bool unpack(std::span<const std::byte> packed, std::size_t element_bytes, std::span<std::byte> raw) {
  std::vector<std::byte> planes(std::min(raw.size(), run_of(element_bytes)));
  while (!raw.empty()) {
    const std::size_t run = std::min(raw.size(), planes.size());
    const std::size_t frame = ZSTD_findFrameCompressedSize(packed.data(), packed.size());
    if (ZSTD_isError(frame) != 0 || ZSTD_decompress(planes.data(), run, packed.data(), frame) != run) return false;
    join(std::span(planes).first(run), element_bytes, raw.first(run));
    packed = packed.subspan(frame);
    raw = raw.subspan(run);
  }
  return packed.empty();
}

}  // namespace occlod::olod

namespace occlod::sections {
namespace {

// The counts of a MeshReport in the order of the file, without left_out, which has a section of its own.
constexpr std::array report_fields = {&MeshReport::vertices_read,
                                      &MeshReport::polygons_read,
                                      &MeshReport::polygons_triangulated,
                                      &MeshReport::triangles_read,
                                      &MeshReport::vertices_welded,
                                      &MeshReport::seam_vertices,
                                      &MeshReport::unreferenced_vertices,
                                      &MeshReport::nonfinite_vertices,
                                      &MeshReport::repeated_index_triangles,
                                      &MeshReport::zero_area_triangles,
                                      &MeshReport::repeated_triangles,
                                      &MeshReport::boundary_edges,
                                      &MeshReport::nonmanifold_edges,
                                      &MeshReport::inconsistent_edges,
                                      &MeshReport::nonmanifold_vertices,
                                      &MeshReport::components};
using StoredReport = std::array<std::uint64_t, report_fields.size()>;

// Of the names of what was left out there are as many as files have; older programs wrote five fixed counts.
constexpr std::string_view report_name = "REPO", left_out_name = "LEFN", fixed_left_out_name = "LEFT",
                           origin_name = "ORIG";
constexpr std::array<std::string_view, 5> fixed_names{"texture coordinates", "normals", "colours", "materials",
                                                      "groups"};

// Writes a line "count name" for each entry.
std::string text_of(const LeftOut& counts) {
  std::string text;
  for (const LeftOut::Entry& entry : counts.entries()) text += fmt::format("{} {}\n", entry.count, entry.name);
  return text;
}

// Reads lines as far as they are well-formed.
LeftOut left_out_of(std::string_view text) {
  LeftOut counts;
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    const char* const end = line.data() + line.size();
    std::uint64_t count = 0;
    const auto [after, problem] = std::from_chars(line.data(), end, count);
    if (problem != std::errc{} || after == end) return counts;
    counts.add({after + 1, end}, count);
    text.remove_prefix(std::min(line.size() + 1, text.size()));
  }
  return counts;
}

std::uint64_t align_up(std::uint64_t offset) { return (offset + alignment - 1) / alignment * alignment; }

std::string_view name_of(const Section& section) { return {section.name.data(), section.name.size()}; }
std::string place_of(const Section& section) {
  return fmt::format("section {} at byte {}", name_of(section), section.offset);
}

}  // namespace

std::uint64_t checksum_of(std::span<const std::byte> bytes) { return XXH3_64bits(bytes.data(), bytes.size()); }

void SectionWriter::add_bytes(std::string_view name, std::span<const std::byte> bytes, std::uint32_t element_bytes,
                              Check check, Codec codec) {
  Section section;
  std::copy_n(name.begin(), section.name.size(), section.name.begin());
  section.element_bytes = element_bytes;
  section.bytes = section.raw_bytes = bytes.size();
  if (check == Check::whole) section.checksum = checksum_of(bytes);
  contents_.push_back(bytes);
  packed_.emplace_back();
  if (codec == Codec::zstd && !bytes.empty()) packed_.back() = olod::pack(bytes, element_bytes);
  // Data that pack better than is_plausible() accepts, such as the normals of a plane, are stored.
  if (!packed_.back().empty() && olod::is_plausible(packed_.back().size(), bytes.size())) {
    contents_.back() = packed_.back();
    section.bytes = packed_.back().size();
    section.codec = Codec::zstd;
  }
  table_.push_back(section);
}

void SectionWriter::add_copy(std::string_view name, std::span<const std::byte> bytes, std::size_t element_bytes) {
  const std::vector<std::byte>& copy = own_.emplace_back(bytes.begin(), bytes.end());
  add_bytes(name, copy, static_cast<std::uint32_t>(element_bytes), Check::whole, Codec::stored);
}

void SectionWriter::add_report(const MeshReport& report) {
  StoredReport counts{};
  std::ranges::transform(report_fields, counts.begin(), [&](auto field) { return report.*field; });
  add_copy(report_name, std::as_bytes(std::span(counts)), sizeof(counts));
  if (report.left_out.empty()) return;
  const std::string text = text_of(report.left_out);
  add_copy(left_out_name, std::as_bytes(std::span(text)), 1);
}

bool SectionWriter::add_origin(const glm::dvec3& origin) {
  if (origin == glm::dvec3(0.0)) return false;
  add_copy(origin_name, std::as_bytes(std::span(&origin, 1)), sizeof(origin));
  return true;
}

void SectionWriter::write(const std::filesystem::path& path, const FileKind& kind) {
  std::uint64_t offset = sizeof(FileHeader) + table_.size() * sizeof(Section);
  for (Section& section : table_) {
    section.offset = align_up(offset);
    offset = section.offset + section.bytes;
  }
  const auto table = std::as_bytes(std::span(table_));
  const FileHeader header{kind.magic, kind.version, static_cast<std::uint32_t>(table_.size()), offset,
                          checksum_of(table)};
  AtomicFile file(path);
  std::uint64_t written = 0;
  const auto put = [&](std::span<const std::byte> bytes) {
    file.write(bytes);
    written += bytes.size();
  };
  put(std::as_bytes(std::span(&header, 1)));
  put(table);
  constexpr std::array<std::byte, alignment> padding{};
  for (std::size_t i = 0; i < table_.size(); ++i) {
    put(std::span(padding).first(table_[i].offset - written));
    put(contents_[i]);
  }
  file.commit();
}

SectionReader::SectionReader(const std::filesystem::path& path, const FileKind& kind, bool is_mapped)
    : path_(path.string()), kind_(kind) {
  if (is_mapped) {
    bytes_ = file_.emplace(path).bytes();
  } else {
    copy_ = read_whole(path);
    bytes_ = copy_;
  }
  size_ = bytes_.size();
  read_header();
  check_table();
}

SectionReader::SectionReader(std::shared_ptr<const ByteSource> file, const std::filesystem::path& path,
                             const FileKind& kind)
    : path_(path.string()), kind_(kind), open_file_(std::move(file)), size_(open_file_->size()) {
  read_header();
  check_table();
}

void SectionReader::refuse(const std::string& place, const std::string& problem, const std::string& remedy) const {
  throw Error({path_, place, problem, remedy});
}

void SectionReader::refuse(const std::string& place, const std::string& problem) const {
  refuse(place, problem, kind_.rebuild);
}

void SectionReader::read_header() {
  FileHeader& header = header_;
  if (size_ >= sizeof(header)) std::memcpy(&header, bytes_at(0, sizeof(header)).data(), sizeof(header));
  if (header.magic != kind_.magic) refuse("byte 0", fmt::format("is not an {} file", kind_.name), kind_.make);
  const std::uint32_t oldest = kind_.oldest_version == 0 ? kind_.version : kind_.oldest_version;
  if (header.version < oldest || header.version > kind_.version)
    refuse("byte 8", fmt::format("is an {} file of version {}, this program reads version {}", kind_.name,
                                 header.version, kind_.version));
  if (header.file_bytes != size_)
    refuse("byte 16", fmt::format("has {} bytes, but says that it has {}: it is truncated or has extra bytes", size_,
                                  header.file_bytes));
  if (header.section_count > max_sections) refuse("byte 12", fmt::format("claims {} sections", header.section_count));
  table_.resize(header.section_count);
  const auto table = std::as_writable_bytes(std::span(table_));
  if (size_ - sizeof(header) < table.size()) refuse("byte 32", "ends inside its section table");
  std::ranges::copy(bytes_at(sizeof(header), table.size()), table.begin());
  if (checksum_of(table) != header.table_checksum)
    refuse("byte 32", "has a damaged section table: its checksum is wrong");
}

void SectionReader::check_table() const {
  const std::uint64_t size = size_;
  for (const Section& section : table_) {
    if (section.offset > size || section.bytes > size - section.offset)
      refuse(place_of(section), "lies outside the file");
    if (section.offset % alignment != 0) refuse(place_of(section), "does not start at a multiple of 64");
    if (section.codec != Codec::stored && section.codec != Codec::zstd)
      refuse(place_of(section),
             fmt::format("is compressed with the unknown codec {}", static_cast<std::uint32_t>(section.codec)),
             "use a newer program");
    if (section.codec == Codec::stored && section.bytes != section.raw_bytes)
      refuse(place_of(section), "has a size that contradicts the table");
    if (!olod::is_plausible(section.bytes, section.raw_bytes))
      refuse(place_of(section), fmt::format("claims {} bytes after decompression", section.raw_bytes));
  }
}

std::vector<Section>::const_iterator SectionReader::find(std::string_view name) const {
  return std::find_if(table_.begin(), table_.end(), [&](const Section& s) { return name_of(s) == name; });
}

const Section& SectionReader::stored_section(std::string_view name) const {
  const auto found = find(name);
  if (found == table_.end()) refuse("", fmt::format("has no section {}", name));
  if (found->codec != Codec::stored) refuse(place_of(*found), "is compressed, which it must not be");
  return *found;
}

std::span<const std::byte> SectionReader::read_bytes(std::string_view name, std::uint32_t element_bytes, Check check) {
  const auto found = find(name);
  if (found == table_.end()) refuse("", fmt::format("has no section {}", name));
  if (found->element_bytes != element_bytes || found->raw_bytes % element_bytes != 0)
    refuse(place_of(*found), "has elements of the wrong size");
  const std::span<const std::byte> bytes = found->codec == Codec::stored ? stored(*found) : unpacked(*found);
  if (check == Check::whole && checksum_of(bytes) != found->checksum)
    refuse(place_of(*found), "is damaged: its checksum is wrong");
  return bytes;
}

std::span<const std::byte> SectionReader::stored(const Section& section) {
  return bytes_at(section.offset, section.bytes);
}

// Returns bytes at a position that is inside the file.
std::span<const std::byte> SectionReader::bytes_at(std::uint64_t offset, std::size_t bytes) {
  if (open_file_ == nullptr) return bytes_.subspan(offset, bytes);
  UninitializedVector<std::byte>& part = parts_.emplace_back(bytes);
  try {
    const std::span<std::byte> whole = part;
    open_file_->read({&whole, 1}, offset);
  } catch (const std::system_error& error) {
    refuse(fmt::format("byte {}", offset), fmt::format("cannot be read: {}", error.code().message()));
  }
  return part;
}

std::span<const std::byte> SectionReader::unpacked(const Section& section) {
  std::vector<std::byte>& raw = unpacked_.emplace_back(section.raw_bytes);
  if (!olod::unpack(stored(section), section.element_bytes, raw))
    refuse(place_of(section), "is damaged: it cannot be decompressed");
  return raw;
}

MeshReport SectionReader::read_report() {
  MeshReport report;
  const auto counts = read_one<StoredReport>(report_name, "report");
  for (std::size_t i = 0; i < counts.size(); ++i) report.*report_fields[i] = counts[i];
  if (has(fixed_left_out_name)) {
    const auto fixed = read_one<std::array<std::uint64_t, fixed_names.size()>>(fixed_left_out_name, "count");
    for (std::size_t i = 0; i < fixed.size(); ++i) report.left_out.add(fixed_names[i], fixed[i]);
  }
  if (has(left_out_name)) {
    const std::span<const char> bytes = read<char>(left_out_name);
    const std::string_view text(bytes.data(), bytes.size());
    report.left_out = left_out_of(text);
    if (text_of(report.left_out) != text) refuse("", "does not list what was left out of its mesh as it should");
  }
  return report;
}

glm::dvec3 SectionReader::read_origin() {
  if (!has(origin_name)) return glm::dvec3(0.0);
  const auto origin = read_one<glm::dvec3>(origin_name, "origin");
  for (int axis = 0; axis < 3; ++axis)
    if (!(std::abs(origin[axis]) <= farthest_coordinate)) refuse("section ORIG", "is not finite or too far away");
  return origin;
}

namespace {

using Json = nlohmann::json;

constexpr std::string_view materials_name = "MATE", images_name = "TEXI";
constexpr const char* wrap_names[] = {"repeat", "clamp", "mirror"};

TextureWrap wrap_of(const Json& name) {
  for (std::size_t i = 0; i < std::size(wrap_names); ++i)
    if (name == wrap_names[i]) return static_cast<TextureWrap>(i);
  throw Json::other_error::create(501, "no wrap mode", &name);
}

constexpr const char* alpha_names[] = {"by_color", "mask", "blend"};

AlphaMode alpha_mode_of(const Json& name) {
  for (std::size_t i = 0; i < std::size(alpha_names); ++i)
    if (name == alpha_names[i]) return static_cast<AlphaMode>(i);
  throw Json::other_error::create(501, "no alpha mode", &name);
}

Json to_json(const Texture& texture) {
  Json json = {{"file", texture.file},
               {"mime_type", texture.mime_type},
               {"bytes", texture.bytes.size()},
               {"wrap_s", wrap_names[static_cast<std::size_t>(texture.wrap_s)]},
               {"wrap_t", wrap_names[static_cast<std::size_t>(texture.wrap_t)]}};
  if (texture.min_filter != 0) json["min_filter"] = texture.min_filter;
  if (texture.mag_filter != 0) json["mag_filter"] = texture.mag_filter;
  return json;
}

// Calls visit(key, field) for each field of a map or a surface that a file may lack.
template <class Map, class Visit>
void for_each_map_field(Map& map, const Visit& visit) {
  visit("texture", map.texture);
  visit("strength", map.strength);
  visit("offset", map.offset);
  visit("rotation", map.rotation);
  visit("scale", map.scale);
}
template <class Look, class Visit>
void for_each_surface_field(Look& surface, const Visit& visit) {
  visit("alpha_mode", surface.alpha_mode);
  visit("alpha_cutoff", surface.alpha_cutoff);
  visit("double_sided", surface.double_sided);
  visit("unlit", surface.unlit);
  visit("metallic", surface.metallic);
  visit("roughness", surface.roughness);
  visit("emissive", surface.emissive);
  visit("metallic_map", surface.metallic_map);
  visit("normal_map", surface.normal_map);
  visit("occlusion_map", surface.occlusion_map);
  visit("emissive_map", surface.emissive_map);
}

template <class T>
Json value_of(const T& field) {
  return field;
}
Json value_of(const AlphaMode& mode) { return alpha_names[static_cast<std::size_t>(mode)]; }
Json value_of(const glm::vec2& v) { return {v.x, v.y}; }
Json value_of(const glm::vec3& v) { return {v.x, v.y, v.z}; }
Json value_of(const TextureMap& map);

template <class T>
void read_value(const Json& json, T& field) {
  field = json.get<T>();
}
void read_value(const Json& json, AlphaMode& mode) { mode = alpha_mode_of(json); }
void read_value(const Json& json, glm::vec2& v) { v = {json.at(0).get<float>(), json.at(1).get<float>()}; }
void read_value(const Json& json, glm::vec3& v) {
  v = {json.at(0).get<float>(), json.at(1).get<float>(), json.at(2).get<float>()};
}
void read_value(const Json& json, TextureMap& map);

// Returns the fields that differ from those of a new object; for_each_field(object, visit) lists them.
template <class Look, class ForEachField>
Json unusual_fields(const Look& look, const ForEachField& for_each_field) {
  Json json = Json::object();
  for_each_field(look, [&](const char* key, const auto& field) { json[key] = value_of(field); });
  const Look usual;
  for_each_field(usual, [&](const char* key, const auto& field) {
    if (json[key] == value_of(field)) json.erase(key);
  });
  return json;
}
template <class Look, class ForEachField>
void read_fields(const Json& json, Look& look, const ForEachField& for_each_field) {
  for_each_field(look, [&](const char* key, auto& field) {
    if (json.contains(key)) read_value(json[key], field);
  });
}

Json value_of(const TextureMap& map) {
  return unusual_fields(map, [](auto& of, const auto& visit) { for_each_map_field(of, visit); });
}

Json to_json(const Surface& surface) {
  return unusual_fields(surface, [](auto& of, const auto& visit) { for_each_surface_field(of, visit); });
}

void read_value(const Json& json, TextureMap& map) {
  read_fields(json, map, [](auto& of, const auto& visit) { for_each_map_field(of, visit); });
}

Json to_json(const Material& material) {
  const glm::vec4& c = material.base_color;
  Json json = {{"name", material.name}, {"base_color", {c.r, c.g, c.b, c.a}}};
  if (material.texture != no_texture) json["texture"] = material.texture;
  if (material.surface != Surface{}) json["surface"] = to_json(material.surface);
  return json;
}

Material material_of(const Json& json) {
  Material material;
  material.name = json.at("name").get<std::string>();
  for (int i = 0; i < 4; ++i)
    material.base_color[i] = json.at("base_color").at(static_cast<std::size_t>(i)).get<float>();
  if (json.contains("texture")) material.texture = json["texture"].get<TextureId>();
  if (json.contains("surface"))
    read_fields(json["surface"], material.surface,
                [](auto& of, const auto& visit) { for_each_surface_field(of, visit); });
  return material;
}

// Converts the names of all materials and image files, which may have any bytes.
void convert_names(Json& json, std::string (*convert)(std::string_view)) {
  const auto convert_in = [&](const char* array, const char* key) {
    for (Json& element : json.at(array)) element.at(key) = convert(element.at(key).get_ref<const std::string&>());
  };
  convert_in("materials", "name");
  convert_in("textures", "file");
}

// Without images, embedded ones are left out.
std::optional<Materials> unpack(std::string_view text, std::optional<std::span<const std::uint8_t>> given) {
  try {
    if (is_nested_too_deeply(text)) return std::nullopt;
    Json json = Json::parse(text);
    convert_names(json, bytes_of_utf8);
    Materials result;
    const std::string origin = json.at("origin").get<std::string>();
    if (origin != "bottom_left" && origin != "top_left") return std::nullopt;
    result.origin = origin == "bottom_left" ? TextureOrigin::bottom_left : TextureOrigin::top_left;
    for (const Json& material : json.at("materials")) result.materials.push_back(material_of(material));
    std::span<const std::uint8_t> images = given.value_or(std::span<const std::uint8_t>());
    for (const Json& texture : json.at("textures")) {
      const auto size = given ? texture.at("bytes").get<std::size_t>() : 0;
      if (size > images.size()) return std::nullopt;
      result.textures.push_back({texture.at("file").get<std::string>(),
                                 texture.at("mime_type").get<std::string>(),
                                 {images.begin(), images.begin() + static_cast<std::ptrdiff_t>(size)},
                                 wrap_of(texture.at("wrap_s")),
                                 wrap_of(texture.at("wrap_t")),
                                 texture.value("min_filter", std::uint16_t{0}),
                                 texture.value("mag_filter", std::uint16_t{0})});
      images = images.subspan(size);
    }
    if (!images.empty()) return std::nullopt;
    if (json.value("up", "z") == "y") result.up = UpAxis::y;
    return result;
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

}  // namespace

std::string text_of(const Surface& surface) { return to_json(surface).dump(); }

void MaterialSections::pack(Materials all, const ImageFolders& folders) {
  lead_to_images(all.textures, folders);
  Json json = {{"materials", Json::array()}, {"textures", Json::array()}};
  json["origin"] = all.origin == TextureOrigin::bottom_left ? "bottom_left" : "top_left";
  if (all.up == UpAxis::y) json["up"] = "y";
  for (const Material& material : all.materials) json["materials"].push_back(to_json(material));
  for (const Texture& texture : all.textures) {
    json["textures"].push_back(to_json(texture));
    images_.insert(images_.end(), texture.bytes.begin(), texture.bytes.end());
  }
  convert_names(json, utf8_of_bytes);
  text_ = json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

void MaterialSections::add_to(SectionWriter& writer) const {
  writer.add(materials_name, std::span<const char>(text_));
  writer.add(images_name, std::span<const std::uint8_t>(images_));
}

Materials read_materials(SectionReader& reader, bool with_images) {
  if (!reader.has(materials_name)) return {};
  const auto text = reader.read<char>(materials_name);
  std::optional<std::span<const std::uint8_t>> images;
  if (with_images) images = reader.read<std::uint8_t>(images_name);
  auto materials = unpack({text.data(), text.size()}, images);
  if (!materials) reader.refuse("section MATE", "does not hold materials");
  return *std::move(materials);
}

}  // namespace occlod::sections
