#include "hlod/build/build_journal.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <cassert>
#include <cstring>
#include <memory>
#include <string_view>
#include <system_error>
#include <utility>

#include "base/memory.h"
#include "hlod/build/build_bytes.h"
#include "hlod/hlod_builder_id.h"
#include "occlod/base.h"

namespace occlod::hlod {
namespace {

constexpr std::array<char, 8> magic = {'O', 'C', 'C', 'L', 'O', 'D', 'H', 'J'};
constexpr const char* grouping_names[] = {"nested", "shifted"};
constexpr const char* borders_names[] = {"free", "locked"};
constexpr const char* within_names[] = {"geomorph", "splits"};
constexpr const char* error_bound_names[] = {"accumulated", "measured"};

// Returns the checksum of a header, without its last member, which stores it.
template <typename T>
std::uint64_t checksum_of(const T& header) {
  return XXH3_64bits(&header, sizeof(header) - sizeof(header.checksum));
}

// Calls visit(piece) for the pieces that are in memory at a time, of an array that may be larger.
template <typename T, typename Visit>
void for_each_piece(std::span<T> values, const Visit& visit) {
  constexpr std::size_t most = std::size_t{1} << 18U;
  for (; !values.empty(); values = values.subspan(std::min(most, values.size()))) {
    make_room();
    visit(values.first(std::min(most, values.size())));
  }
}

// Returns a hash of all that nodes depend on. The arrays may be larger than memory.
std::uint64_t hash_of(const WedgeMesh& mesh) {
  const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(), &XXH3_freeState);
  XXH3_64bits_reset(state.get());
  const auto add = [&](const auto& values) {
    const std::size_t size = values.size();
    XXH3_64bits_update(state.get(), &size, sizeof(size));
    for_each_piece(std::span(values),
                   [&](const auto& piece) { XXH3_64bits_update(state.get(), piece.data(), piece.size_bytes()); });
  };
  add(mesh.positions);
  add(mesh.normals);
  add(mesh.colors);
  add(mesh.texture_coordinates);
  add(mesh.extra_wedges);
  add(mesh.triangles);
  add(mesh.corners);
  add(mesh.wedge_materials);
  add(mesh.wedge_features);
  return XXH3_64bits_digest(state.get());
}

}  // namespace

BuildJournal::BuildJournal(std::filesystem::path path, const HlodBuildOptions& options) : path_(std::move(path)) {
  wanted_.magic = magic;
  static_assert(sizeof(hlod_builder_id) == sizeof(wanted_.builder) + 1);
  std::copy_n(hlod_builder_id, wanted_.builder.size(), wanted_.builder.begin());
  wanted_.node_triangles = options.node_triangles;
  wanted_.grouping = static_cast<std::uint32_t>(options.grouping);
  wanted_.borders = static_cast<std::uint32_t>(options.borders);
  wanted_.within = static_cast<std::uint16_t>(options.within);
  wanted_.error_bound = static_cast<std::uint16_t>(options.error_bound);
  if (std::error_code ignored; std::filesystem::exists(path_, ignored)) open();
}

void BuildJournal::refuse(std::string place, std::string problem, std::string remedy) const {
  throw Error({path_.string(), std::move(place), std::move(problem), std::move(remedy)});
}

void BuildJournal::open() {
  records_.emplace(path_);
  read_header();
  if (found_) check(*found_);
}

// Reads the header into found_, if it is undamaged; otherwise no record of the journal can be trusted.
void BuildJournal::read_header() {
  Header header;
  const std::size_t size = records_->read_header(writable_bytes_of(header));
  if (!std::equal(magic.begin(), magic.begin() + static_cast<std::ptrdiff_t>(std::min(size, magic.size())),
                  header.magic.begin()))
    refuse("", "is not a journal of an HLOD build", "move it away");
  if (size == sizeof(header) && header.checksum == checksum_of(header)) found_ = header;
}

void BuildJournal::check(const Header& found) const {
  const char* const remedy = "build with the same, or remove the journal to start anew";
  const auto compare = [&](const char* option, const auto& theirs, const auto& ours) {
    if (theirs != ours)
      refuse(fmt::format("option {}", option),
             fmt::format("is {} in the build that left the journal, {} in this one", theirs, ours), remedy);
  };
  const auto name = [](const auto& names, std::uint32_t value) {
    return value < std::size(names) ? std::string_view(names[value]) : "unknown";
  };
  if (found.builder != wanted_.builder)
    refuse("", "is the journal of another version of this program", "remove it to start anew");
  compare("node_triangles", found.node_triangles, wanted_.node_triangles);
  compare("grouping", name(grouping_names, found.grouping), name(grouping_names, wanted_.grouping));
  compare("borders", name(borders_names, found.borders), name(borders_names, wanted_.borders));
  compare("within", name(within_names, found.within), name(within_names, wanted_.within));
  compare("error_bound", name(error_bound_names, found.error_bound), name(error_bound_names, wanted_.error_bound));
}

void BuildJournal::begin(const WedgeMesh& mesh) {
  wanted_.mesh = hash_of(mesh);
  wanted_.checksum = checksum_of(wanted_);
  if (!records_) open();
  if (found_ && found_->mesh != wanted_.mesh)
    refuse("", "is the journal of another mesh",
           "build the same input, with a memory limit or without as before, or remove the journal to start anew");
  if (found_)
    records_->go_to({sizeof(Header), wanted_.checksum});
  else
    records_->restart(bytes_of(wanted_), wanted_.checksum);
}

bool BuildJournal::take(std::size_t triangles, TriangleGroups& groups) {
  if (all_taken_) return false;
  const JournalRecords::Place place = records_->place();
  bool is_whole = records_->take(bytes_);
  if (is_whole) {
    assert(bytes_.size() == sizeof(groups.count));
    std::memcpy(&groups.count, bytes_.data(), sizeof(groups.count));
    groups.group_of.resize(triangles);
    for_each_piece(std::span(groups.group_of), [&](std::span<std::uint32_t> piece) {
      is_whole = is_whole && records_->take(bytes_);
      if (is_whole) std::ranges::copy(bytes_, std::as_writable_bytes(piece).begin());
    });
  }
  if (is_whole) return true;
  records_->go_to(place);
  stop_taking();
  return false;
}

void BuildJournal::append(const TriangleGroups& groups) {
  bytes_.resize(sizeof(JournalRecords::Head));
  put_bytes(bytes_, bytes_of(groups.count));
  records_->append(bytes_);
  for_each_piece(std::span(groups.group_of), [&](std::span<const std::uint32_t> piece) {
    bytes_.resize(sizeof(JournalRecords::Head));
    put_bytes(bytes_, std::as_bytes(piece));
    records_->append(bytes_);
  });
}

void BuildJournal::stop_taking() {
  all_taken_ = true;
  records_->cut_rest();
}

bool BuildJournal::take(SimplifiedNode& node) {
  if (all_taken_) return false;
  if (!records_->take(bytes_)) {
    stop_taking();
    return false;
  }
  std::span<const std::byte> left = bytes_;
  get_node(left, node);
  ++taken_;
  return true;
}

void BuildJournal::append(const SimplifiedNode& node) {
  bytes_.resize(sizeof(JournalRecords::Head));
  put_node(bytes_, node);
  records_->append(bytes_);
}

}  // namespace occlod::hlod
