// Records in a file what a build has finished, so that the same build can resume from it after an interruption.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "hlod/build/finish_level.h"
#include "hlod/build/group_triangles.h"
#include "hlod/build/journal_records.h"
#include "hlod/build/level_draft.h"
#include "occlod/build_hlod.h"

namespace occlod::hlod {

// Stores the groups of the input and then, for each level, the groups that its nodes are made from and its nodes. The
// caller first takes what the file has, in order, and then appends the rest. Whatever follows the last whole and
// undamaged record is cut off. All functions throw Error that names the file.
class BuildJournal {
 public:
  // Opens the file if it exists, but does not create it. Throws Error when another build uses the file, when it is not
  // a journal, or when it belongs to another version or to a build with other options.
  BuildJournal(std::filesystem::path path, const HlodBuildOptions& options);

  // Must be called first, with the mesh as the build has it at that time. Creates the file if need be. Throws Error
  // like the constructor, and for a journal of another mesh. O(n).
  void begin(const WedgeMesh& mesh);
  // Reads the groups of the next level, which has this many triangles. Returns false when the file has none; from then
  // on all calls must append.
  [[nodiscard]] bool take(std::size_t triangles, TriangleGroups& groups);
  // Reads the next node of the level as the simplifier made it, with its own numbers for the wedges that it adds.
  // Returns false when the file has none; from then on all calls must append.
  [[nodiscard]] bool take(SimplifiedNode& node);
  // Appends a record; allowed once take() has returned false. The record survives the process, but perhaps not a system
  // crash.
  void append(const TriangleGroups& groups);
  void append(const SimplifiedNode& node);
  // Returns the number of nodes that were taken.
  [[nodiscard]] std::size_t taken() const noexcept { return taken_; }

 private:
  // The layout is the same in all versions.
  struct Header {
    std::array<char, 8> magic{};
    std::array<char, 64> builder{};  // hash of all sources that decide the contents of the records
    std::uint32_t node_triangles = 0, grouping = 0, borders = 0;
    std::uint16_t within = 0, error_bound = 0;
    double boundary_weight = build_weights.boundary, attribute_weight = build_weights.attributes;
    std::uint64_t mesh = 0;      // XXH3-64 of the mesh's arrays
    std::uint64_t checksum = 0;  // XXH3-64 of all fields before this one
  };
  static_assert(sizeof(Header) == 120);

  void open();
  void read_header();
  void check(const Header& found) const;
  void stop_taking();
  [[noreturn]] void refuse(std::string place, std::string problem, std::string remedy) const;

  std::filesystem::path path_;
  Header wanted_;  // header that this build writes or expects
  std::optional<JournalRecords> records_;
  std::optional<Header> found_;  // header in the file
  bool all_taken_ = false;
  std::size_t taken_ = 0;
  std::vector<std::byte> bytes_;  // one record, with its head when it is appended
};

// As without `taken`, which becomes the number of nodes that the build took over from its journal. `report` is that of
// a mesh in memory, and counts what rounding changes.
[[nodiscard]] Hlod build_hlod(const TriangleMesh& mesh, const HlodBuildOptions& options, MeshReport& report,
                              std::size_t& taken);
[[nodiscard]] Hlod build_hlod(const TriangleSource& source, const HlodBuildOptions& options, MeshReport& report,
                              std::size_t& taken);

}  // namespace occlod::hlod
