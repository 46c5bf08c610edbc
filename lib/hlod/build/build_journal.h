// What a build has finished, in a file, so that the same build takes it over when it starts again.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/platform.h"
#include "hlod/build/finish_level.h"
#include "hlod/build/group_triangles.h"
#include "hlod/build/level_draft.h"
#include "occlod/build_hlod.h"

namespace occlod::hlod {

// The groups of the input, then for each level the groups that its nodes are made from, and its nodes. First what the
// file has is taken, in order, then the rest is appended. What follows the last whole node or groups, or damaged ones,
// is cut off. All functions throw Error that names the file.
class BuildJournal {
 public:
  // Of a file that need not exist, and is not made yet. Throws Error for one that another build uses, that is no
  // journal, or is that of another version or of a build with other options.
  BuildJournal(std::filesystem::path path, const HlodBuildOptions& options);

  // Before all else, with the mesh as the build has it then. Makes the file. Throws Error likewise, and
  // for a journal of another mesh. O(n).
  void begin(const WedgeMesh& mesh);
  // The groups of the next level, of so many triangles. False: it has none, and from now on all is appended.
  [[nodiscard]] bool take(std::size_t triangles, TriangleGroups& groups);
  // The next node of the level, as the simplifier made it: so with its own numbers for the wedges that it adds.
  // Likewise.
  [[nodiscard]] bool take(SimplifiedNode& node);
  // After take() has returned false. It outlives the process, but perhaps not the system.
  void append(const TriangleGroups& groups);
  void append(const SimplifiedNode& node);
  // Nodes so far.
  [[nodiscard]] std::size_t taken() const noexcept { return taken_; }

 private:
  // All versions have the same.
  struct Header {
    std::array<char, 8> magic{};
    std::array<char, 64> builder{};  // a hash of all sources that decide what is in the rest
    std::uint32_t node_triangles = 0, grouping = 0, borders = 0, within = 0;
    double boundary_weight = build_weights.boundary, attribute_weight = build_weights.attributes;
    std::uint64_t mesh = 0;      // XXH3-64 of its arrays
    std::uint64_t checksum = 0;  // XXH3-64 of what is above
  };
  static_assert(sizeof(Header) == 120);

  // Before each node, and each piece of groups.
  struct RecordHead {
    std::uint64_t bytes = 0;          // of what follows
    std::uint64_t body_checksum = 0;  // XXH3-64 of that
    std::uint64_t checksum = 0;       // of what is above, seeded with that of the record before: records have one order
  };

  void open();
  void read_header();
  void check(const Header& found) const;
  [[nodiscard]] bool read_record();
  void append_record();
  void stop_taking();
  void read(std::span<std::byte> bytes, std::uint64_t offset) const;
  void write(std::span<const std::byte> bytes);
  void cut(std::uint64_t size);
  [[noreturn]] void refuse(std::string place, std::string problem, std::string remedy) const;

  std::filesystem::path path_;
  Header wanted_;  // of this build
  std::optional<JournalFile> file_;
  std::optional<Header> found_;  // in the file
  std::uint64_t place_ = 0;      // of what is taken next
  std::uint64_t checksum_ = 0;   // of the last one taken or appended; at first that of the header
  bool all_taken_ = false;
  std::size_t taken_ = 0;
  std::vector<std::byte> bytes_;  // of one record, with its head when it is appended
};

// As without `taken`, which becomes the number of nodes that the build took over from its journal.
[[nodiscard]] Hlod build_hlod(const TriangleMesh& mesh, const HlodBuildOptions& options, std::size_t& taken);
[[nodiscard]] Hlod build_hlod(const TriangleSource& source, const HlodBuildOptions& options, MeshReport& report,
                              std::size_t& taken);

}  // namespace occlod::hlod
