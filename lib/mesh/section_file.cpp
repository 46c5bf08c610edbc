#include "mesh/section_file.h"

#include <fmt/format.h>
#include <xxhash.h>
#include <zstd.h>

#include <algorithm>
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

// The counts of a MeshReport without left_out, which is a section of its own that exists only when one of its numbers
// is not 0.
using StoredReport = std::array<std::uint64_t, 16>;
static_assert(offsetof(MeshReport, left_out) == sizeof(StoredReport));
static_assert(sizeof(MeshReport) == sizeof(StoredReport) + sizeof(LeftOut) && sizeof(LeftOut) == 40);

constexpr std::string_view report_name = "REPO", left_out_name = "LEFT", origin_name = "ORIG";

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

void SectionWriter::add_copy(std::string_view name, const void* value, std::size_t bytes) {
  std::vector<std::byte>& copy = own_.emplace_back(bytes);
  std::memcpy(copy.data(), value, bytes);
  add_bytes(name, copy, static_cast<std::uint32_t>(bytes), Check::whole, Codec::stored);
}

void SectionWriter::add_report(const MeshReport& report) {
  add_copy(report_name, &report, sizeof(StoredReport));
  if (report.left_out != LeftOut{}) add_copy(left_out_name, &report.left_out, sizeof(LeftOut));
}

bool SectionWriter::add_origin(const glm::dvec3& origin) {
  if (origin == glm::dvec3(0.0)) return false;
  add_copy(origin_name, &origin, sizeof(origin));
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

SectionReader::SectionReader(std::shared_ptr<const InputFile> file, const std::filesystem::path& path,
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
    open_file_->read(part, offset);
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
  const auto stored_report = read_one<StoredReport>(report_name, "report");
  std::memcpy(static_cast<void*>(&report), stored_report.data(), sizeof(StoredReport));  // all fields but left_out
  if (has(left_out_name)) report.left_out = read_one<LeftOut>(left_out_name, "count of what was left out");
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

Json to_json(const Texture& texture) {
  return {{"file", texture.file},
          {"mime_type", texture.mime_type},
          {"bytes", texture.bytes.size()},
          {"wrap_s", wrap_names[static_cast<std::size_t>(texture.wrap_s)]},
          {"wrap_t", wrap_names[static_cast<std::size_t>(texture.wrap_t)]}};
}

Json to_json(const Material& material) {
  const glm::vec4& c = material.base_color;
  Json json = {{"name", material.name}, {"base_color", {c.r, c.g, c.b, c.a}}};
  if (material.texture != no_texture) json["texture"] = material.texture;
  return json;
}

Material material_of(const Json& json) {
  Material material;
  material.name = json.at("name").get<std::string>();
  for (int i = 0; i < 4; ++i)
    material.base_color[i] = json.at("base_color").at(static_cast<std::size_t>(i)).get<float>();
  if (json.contains("texture")) material.texture = json["texture"].get<TextureId>();
  return material;
}

std::optional<Materials> unpack(std::string_view text, std::span<const std::uint8_t> images) {
  try {
    const Json json = Json::parse(text);
    Materials result;
    const std::string origin = json.at("origin").get<std::string>();
    if (origin != "bottom_left" && origin != "top_left") return std::nullopt;
    result.origin = origin == "bottom_left" ? TextureOrigin::bottom_left : TextureOrigin::top_left;
    for (const Json& material : json.at("materials")) result.materials.push_back(material_of(material));
    for (const Json& texture : json.at("textures")) {
      const auto size = texture.at("bytes").get<std::size_t>();
      if (size > images.size()) return std::nullopt;
      result.textures.push_back({texture.at("file").get<std::string>(),
                                 texture.at("mime_type").get<std::string>(),
                                 {images.begin(), images.begin() + static_cast<std::ptrdiff_t>(size)},
                                 wrap_of(texture.at("wrap_s")),
                                 wrap_of(texture.at("wrap_t"))});
      images = images.subspan(size);
    }
    if (!images.empty()) return std::nullopt;
    return result;
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

}  // namespace

void MaterialSections::pack(std::span<const Material> materials, std::span<const Texture> textures,
                            TextureOrigin origin) {
  Json json = {{"materials", Json::array()}, {"textures", Json::array()}};
  json["origin"] = origin == TextureOrigin::bottom_left ? "bottom_left" : "top_left";
  for (const Material& material : materials) json["materials"].push_back(to_json(material));
  for (const Texture& texture : textures) {
    json["textures"].push_back(to_json(texture));
    images_.insert(images_.end(), texture.bytes.begin(), texture.bytes.end());
  }
  // Names may contain invalid UTF-8.
  text_ = json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

void MaterialSections::add_to(SectionWriter& writer) const {
  writer.add(materials_name, std::span<const char>(text_));
  writer.add(images_name, std::span<const std::uint8_t>(images_));
}

Materials read_materials(SectionReader& reader) {
  if (!reader.has(materials_name)) return {};
  const auto text = reader.read<char>(materials_name);
  auto materials = unpack({text.data(), text.size()}, reader.read<std::uint8_t>(images_name));
  if (!materials) reader.refuse("section MATE", "does not hold materials");
  return *std::move(materials);
}

}  // namespace occlod::sections
