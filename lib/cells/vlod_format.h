// Declares what the writer and the reader of .vlod files share.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mesh/section_file.h"
#include "occlod/vlod_file.h"

namespace occlod::vlod {

// The carriage returns and the end-of-file byte reveal a transfer in text mode, as in PNG.
inline constexpr sections::FileKind file_kind{{'V', 'L', 'O', 'D', '\r', '\n', '\x1a', '\n'},
                                              vlod_version,
                                              ".vlod",
                                              "make one with 'occlod cells build'",
                                              "build it again with 'occlod cells build'"};

// Kind of files with geometry. It has another version, so that programs that do not support it reject them.
inline constexpr sections::FileKind packed_kind{
    file_kind.magic,    textured_vlod_version, file_kind.name, file_kind.make, "pack it again with 'occlod cells pack'",
    packed_vlod_version};

using Key = std::array<std::uint64_t, 2>;

// Holds CellTreeOptions without the regions, and everything else that determines the contents of a file.
struct StoredOptions {
  Key key{};                // of all that follows, the regions and the objects
  std::uint32_t epoch = 0;  // version of the algorithm that makes cells
  std::uint32_t division = 0;
  std::uint32_t levels = 0;
  std::uint32_t occlusion = 0;
  double focal_length_px = 0.0, cos_corner_angle = 0.0, near = 0.0, clearance = 0.0;
  double tolerance_px = 0.0;
  double root_cell = 0.0, smallest_cell = 0.0, occluder_motion = 0.0;
  std::uint64_t max_triangles = 0, budget = 0, sampled_eyes = 0;
  std::uint64_t reserved = 0;
};
static_assert(sizeof(StoredOptions) == 128);

// Describes an object that the cells were built for.
struct StoredObject {
  std::array<std::uint64_t, 2> hierarchy{};  // XXH3-128 of all that is in its hierarchy
  std::uint32_t split_count = 0;             // of its hierarchy
  std::uint32_t two_sided = 0;               // 0 or 1
  std::uint32_t ignores_attributes = 0;      // 1 where attributes slip, and do not count: RefineObject::attributes
  std::uint32_t reserved = 0;                // 0
  glm::dmat4 object_to_world{1.0};           // of its placement
};
static_assert(sizeof(StoredObject) == 160);
static_assert(sizeof(CellNode) == 104);

// Version of the algorithm that makes cells: shards of different epochs are incompatible.
inline constexpr std::uint32_t epoch = 2;

inline constexpr std::string_view options_name = "OPTS", regions_name = "REGN", objects_name = "OBJS",
                                  nodes_name = "CELL", data_name = "DATA";

inline constexpr std::uint32_t max_payload_bytes = 16U << 20U;
// Maximum number of ids per byte of a payload: decoding takes at most 64 times the size of the file in memory, whatever
// the file claims.
inline constexpr std::uint32_t max_ids_per_byte = 8;
// Maximum number of ids per byte in packed files, where ids form few runs. No node has more ids than the geometry.
inline constexpr std::uint32_t max_packed_ids_per_byte = 64;

// How often root cells are divided at most. Files that were built with another limit are read, too.
inline constexpr std::uint32_t max_cell_levels = 10;

// Holds everything that determines the contents of a file.
struct Scene {
  CellTreeOptions options;
  std::vector<StoredObject> objects;
  std::uint32_t levels = max_cell_levels;  // largest number of levels of cells below the root cells
};

// Describes the objects. Reads all of their hierarchies, which must not be null.
[[nodiscard]] std::vector<StoredObject> describe(std::span<const RefineObject> objects);
// Returns the options with their key.
[[nodiscard]] StoredOptions store(const Scene& scene);
[[nodiscard]] CellTreeOptions restore(const StoredOptions& stored, std::span<const CellBox> regions);

// Reads and checks the start of files of either kind, and their key.
[[nodiscard]] Scene read_options(sections::SectionReader& reader, const std::string& subject, Key& key);

// Throws Error that names the invalid option or field of the file.
void check(const CellTreeOptions& options, const char* subject);

// Numbers the splits of all objects consecutively, and likewise the owners of faces: per object a base mesh, then its
// splits.
class GlobalIds {
 public:
  // Throws Error when there are 2^32 or more.
  GlobalIds(std::span<const StoredObject> objects, const std::string& subject);

  [[nodiscard]] std::uint64_t split_count() const noexcept { return first_.back(); }
  [[nodiscard]] std::uint64_t owner_count() const noexcept { return first_.back() + first_.size() - 1; }
  [[nodiscard]] std::uint64_t split(std::uint32_t object, SplitId s) const { return first_[object] + s; }
  // Returns the owner's number; no_id for the base mesh.
  [[nodiscard]] std::uint64_t owner(std::uint32_t object, SplitId s) const {
    return first_[object] + object + (s == no_id ? 0 : s + std::uint64_t{1});
  }
  struct Place {
    std::uint32_t object;
    SplitId split;  // or no_id
  };
  [[nodiscard]] Place place_of_split(std::uint64_t split) const;
  [[nodiscard]] Place place_of_owner(std::uint64_t owner) const;

 private:
  std::vector<std::uint64_t> first_;  // first split of each object, then the total
};

}  // namespace occlod::vlod
