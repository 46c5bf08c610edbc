// The parts that writing and reading .vlod files share.
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

// With geometry. Of another version, so that programs that do not know it refuse them.
inline constexpr sections::FileKind packed_kind{
    file_kind.magic,    textured_vlod_version, file_kind.name, file_kind.make, "pack it again with 'occlod cells pack'",
    packed_vlod_version};

using Key = std::array<std::uint64_t, 2>;

// CellTreeOptions without the regions, and all else that decides what is in a file.
struct StoredOptions {
  Key key{};                // of all that follows, the regions and the objects
  std::uint32_t epoch = 0;  // of the way in which cells are made
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

// Files of another epoch were made in another way: shards of them do not fit together.
inline constexpr std::uint32_t epoch = 2;

inline constexpr std::string_view options_name = "OPTS", regions_name = "REGN", objects_name = "OBJS",
                                  nodes_name = "CELL", data_name = "DATA";

inline constexpr std::uint32_t max_payload_bytes = 16U << 20U;
// Ids that a payload may hold, for each byte of it: what a file claims takes no more than 64 times its size in memory.
inline constexpr std::uint32_t max_ids_per_byte = 8;
// In packed files, where ids are a few runs. No node has more than there are in the geometry.
inline constexpr std::uint32_t max_packed_ids_per_byte = 64;

// What decides what is in a file.
struct Scene {
  CellTreeOptions options;
  std::vector<VlodObject> objects;
};

// Reads all of the hierarchies, which must not be missing.
[[nodiscard]] std::vector<VlodObject> describe(std::span<const RefineObject> objects);
// With its key.
[[nodiscard]] StoredOptions store(const Scene& scene);
[[nodiscard]] CellTreeOptions restore(const StoredOptions& stored, std::span<const CellBox> regions);

// What files of either kind begin with, checked, and its key.
[[nodiscard]] Scene read_options(sections::SectionReader& reader, const std::string& subject, Key& key);

// Throws Error that names the option, or the field of the file that was read.
void check(const CellTreeOptions& options, const char* subject);

// Splits of all objects are numbered through, and so are what faces belong to: a base mesh, then its splits.
class GlobalIds {
 public:
  // Throws Error when there are 2^32 or more.
  GlobalIds(std::span<const VlodObject> objects, const std::string& subject);

  [[nodiscard]] std::uint64_t split_count() const noexcept { return first_.back(); }
  [[nodiscard]] std::uint64_t owner_count() const noexcept { return first_.back() + first_.size() - 1; }
  [[nodiscard]] std::uint64_t split(std::uint32_t object, SplitId s) const { return first_[object] + s; }
  // no_id: the base mesh.
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
  std::vector<std::uint64_t> first_;  // split of each object, and their number
};

}  // namespace occlod::vlod
