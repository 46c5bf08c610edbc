#include "hlod/store/remote_ohlod.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>
#include <deque>
#include <iterator>
#include <set>
#include <system_error>
#include <utility>

#include "base/byte_source.h"
#include "hlod/store/mesh_loader.h"
#include "hlod/store/ohlod.h"
#include "mesh/section_file.h"
#include "occlod/base.h"

namespace occlod::hlod {

// What has come of a file. Says what a read lacked.
class RemoteBytes final : public ByteSource {
 public:
  explicit RemoteBytes(std::uint64_t size) : size_(size) {}

  void put(std::uint64_t offset, std::span<const std::byte> bytes) {
    if (offset > size_ || bytes.size() > size_ - offset) return;
    pieces_.push_back({offset, {bytes.begin(), bytes.end()}});
  }
  void forget() {
    pieces_.clear();
    pieces_.shrink_to_fit();
  }

  [[nodiscard]] std::uint64_t size() const noexcept override { return size_; }

  void read(std::span<const std::span<std::byte>> parts, std::uint64_t offset) const override {
    for (const std::span<std::byte> part : parts) {
      const ByteRange range{offset, offset + part.size()};
      for (std::uint64_t at = range.begin; at < range.end;) {
        const Piece* const piece = piece_with(at);
        if (piece == nullptr) {
          if (!lacking_) lacking_ = ByteRange{at, range.end};
          throw std::system_error(std::make_error_code(std::errc::resource_unavailable_try_again));
        }
        const auto from = static_cast<std::size_t>(at - piece->offset);
        const auto count =
            static_cast<std::size_t>(std::min<std::uint64_t>(range.end - at, piece->bytes.size() - from));
        std::copy_n(piece->bytes.begin() + static_cast<std::ptrdiff_t>(from), count,
                    part.begin() + static_cast<std::ptrdiff_t>(at - range.begin));
        at += count;
      }
      offset = range.end;
    }
  }

  // Returns what the first read that failed since the last call lacked.
  [[nodiscard]] std::optional<ByteRange> take_lacking() { return std::exchange(lacking_, std::nullopt); }

  // Returns the parts of ranges, ascending and apart, that have not come.
  [[nodiscard]] std::vector<ByteRange> missing(std::span<const ByteRange> ranges) const {
    std::vector<ByteRange> result;
    for (ByteRange range : ranges) {
      while (range.begin < range.end) {
        if (const Piece* const piece = piece_with(range.begin)) {
          range.begin = piece->offset + piece->bytes.size();
          continue;
        }
        ByteRange gap = range;
        for (const Piece& piece : pieces_)
          if (piece.offset > range.begin) gap.end = std::min(gap.end, piece.offset);
        result.push_back(gap);
        range.begin = gap.end;
      }
    }
    return result;
  }

 private:
  struct Piece {
    std::uint64_t offset;
    std::vector<std::byte> bytes;
  };

  [[nodiscard]] const Piece* piece_with(std::uint64_t at) const {
    const auto found = std::ranges::find_if(
        pieces_, [&](const Piece& piece) { return piece.offset <= at && at - piece.offset < piece.bytes.size(); });
    return found == pieces_.end() ? nullptr : &*found;
  }

  std::uint64_t size_;
  std::vector<Piece> pieces_;
  mutable std::optional<ByteRange> lacking_;
};

// Gives the loads of a store away as requests: one for meshes, and one for images where nodes have them. A request that
// has begun is taken back with all others when a frame ends, and kept if its nodes are wanted again.
class RemoteLoads final : public LoadQueue {
 public:
  // `place`: of the meshes in the file. Images that have come pass through `bytes`, of which the source reads them.
  RemoteLoads(MeshSource& source, std::uint64_t place, std::shared_ptr<RemoteBytes> bytes)
      : source_(source), place_(place), bytes_(std::move(bytes)) {}

  [[nodiscard]] bool is_lost() const noexcept override { return false; }

  void push(std::vector<MeshLoad> loads) override {
    for (const MeshLoad& load : loads) {
      const auto count = static_cast<NodeId>(load.meshes.size());
      NodeId begin = 0;
      for (NodeId i = 0; i < count; ++i) {
        Flight* const flight = flight_of(load.first + i);
        if (flight == nullptr) continue;
        flight->wanted[load.first + i - flight->first] = true;
        wait_for(load.first + begin, i - begin);
        begin = i + 1;
      }
      wait_for(load.first + begin, count - begin);
    }
    std::erase_if(flights_, [&](const Flight& flight) {
      const bool is_wanted = std::ranges::find(flight.wanted, true) != flight.wanted.end();
      if (!is_wanted) cancel(flight);
      return !is_wanted;
    });
  }

  [[nodiscard]] std::vector<MeshLoad> withdraw() override {
    std::vector<MeshLoad> loads(std::move_iterator(waiting_.begin()), std::move_iterator(waiting_.end()));
    waiting_.clear();
    for (Flight& flight : flights_)
      for_each_wanted(flight, [&](NodeId first, NodeId count) {
        loads.push_back(load_of(first, count));
        for (NodeId i = 0; i < count; ++i) flight.wanted[first + i - flight.first] = false;
      });
    return loads;
  }

  void collect(std::deque<MeshLoad>& out, std::size_t /*least*/) override {
    std::ranges::move(ended_, std::back_inserter(out));
    ended_.clear();
  }

  [[nodiscard]] std::optional<RemoteRequest> next() {
    for (Flight& flight : flights_)
      for (Part& part : flight.parts)
        if (part.id == 0) return begun(flight, part);
    if (waiting_.empty()) return std::nullopt;
    const MeshLoad load = std::move(waiting_.front());
    waiting_.pop_front();
    const auto count = static_cast<NodeId>(load.meshes.size());
    const std::uint64_t begin = place_ + source_.stored(load.first).place;
    Flight flight{load.first, std::vector<bool>(count, true), false, {}};
    flight.parts.push_back({0, {begin, begin + load.bytes}, {}});
    if (const ByteRange images = images_of(load.first, count); images.begin < images.end)
      flight.parts.push_back({0, images, {}});
    for (NodeId i = 0; i < count; ++i) flight.again = flight.again || damaged_.contains(load.first + i);
    flights_.push_back(std::move(flight));
    return begun(flights_.back(), flights_.back().parts[0]);
  }

  void arrive(std::uint32_t id, std::span<const std::byte> bytes) {
    const auto [flight, part] = find(id);
    if (flight == flights_.end()) return;
    if (bytes.size() != part->range.end - part->range.begin) return lose(id);
    part->bytes.assign(bytes.begin(), bytes.end());
    if (!std::ranges::all_of(flight->parts, [](const Part& other) { return other.is_here(); })) return;
    const Flight whole = take(flight);
    if (whole.parts.size() > 1) bytes_->put(whole.parts[1].range.begin, whole.parts[1].bytes);
    for_each_wanted(whole, [&](NodeId first, NodeId count) { unpack(whole, first, count); });
    bytes_->forget();
  }

  void lose(std::uint32_t id) {
    const auto [flight, part] = find(id);
    if (flight == flights_.end()) return;
    part->id = 0;
    if (std::ranges::any_of(flight->parts, [](const Part& other) { return other.id != 0; })) return;
    for_each_wanted(take(flight), [&](NodeId first, NodeId count) { wait_for(first, count); });
  }

  void fail(std::uint32_t id, const std::string& problem) {
    const auto [flight, part] = find(id);
    if (flight == flights_.end()) return;
    part->id = 0;
    cancel(*flight);
    for_each_wanted(take(flight), [&](NodeId first, NodeId count) {
      MeshLoad load = load_of(first, count);
      load.problems.assign(count, problem);
      ended_.push_back(std::move(load));
    });
  }

  [[nodiscard]] std::vector<std::uint32_t> take_cancelled() { return std::exchange(cancelled_, {}); }

 private:
  // More than this is not asked for at once, unless it belongs to one node: it would arrive late.
  static constexpr std::uint64_t most_bytes = 1U << 20U;

  struct Part {
    std::uint32_t id = 0;  // of its request; 0: it is to be asked for
    ByteRange range;       // in the file
    std::vector<std::byte> bytes;

    [[nodiscard]] bool is_here() const noexcept { return !bytes.empty(); }
  };
  struct Flight {
    NodeId first = 0;
    std::vector<bool> wanted;  // by node, from `first` on
    bool again = false;
    std::vector<Part> parts;  // meshes; images, if any
  };
  using Flights = std::vector<Flight>;

  [[nodiscard]] RemoteRequest begun(const Flight& flight, Part& part) {
    part.id = ++last_id_;
    return {part.id, part.range, flight.again};
  }

  void cancel(const Flight& flight) {
    for (const Part& part : flight.parts)
      if (part.id != 0 && !part.is_here()) cancelled_.push_back(part.id);
  }

  [[nodiscard]] MeshLoad load_of(NodeId first, NodeId count) const {
    MeshLoad load{first, 0, std::vector<MeshBytes>(count), {}};
    for (NodeId i = 0; i < count; ++i) load.bytes += source_.stored(first + i).bytes;
    return load;
  }

  // Returns what holds the images of some nodes; nothing where they have none.
  [[nodiscard]] ByteRange images_of(NodeId first, NodeId count) const {
    ByteRange range;
    for (NodeId n = first; n < first + count; ++n)
      if (const StoredImage image = source_.stored_image(n); image.bytes > 0)
        range = range.end == 0 ? ByteRange{image.place, image.place + image.bytes}
                               : ByteRange{std::min(range.begin, image.place),
                                           std::max<std::uint64_t>(range.end, image.place + image.bytes)};
    return range;
  }

  void wait_for(NodeId first, NodeId count) {
    while (count > 0) {
      NodeId part = count;
      for (ByteRange images = images_of(first, part); part > 1 && images.end - images.begin > most_bytes;
           images = images_of(first, part))
        part = (part + 1) / 2;
      waiting_.push_back(load_of(first, part));
      first += part;
      count -= part;
    }
  }

  [[nodiscard]] Flight* flight_of(NodeId n) {
    const auto found = std::ranges::find_if(
        flights_, [&](const Flight& flight) { return flight.first <= n && n - flight.first < flight.wanted.size(); });
    return found == flights_.end() ? nullptr : &*found;
  }

  // Returns the flight that waits for this request, and the part that it is for; flights_.end() where none does.
  [[nodiscard]] std::pair<Flights::iterator, Part*> find(std::uint32_t id) {
    for (auto flight = flights_.begin(); flight != flights_.end(); ++flight)
      for (Part& part : flight->parts)
        if (part.id == id && !part.is_here()) return {flight, &part};
    return {flights_.end(), nullptr};
  }

  [[nodiscard]] Flight take(Flights::iterator found) {
    Flight flight = std::move(*found);
    flights_.erase(found);
    return flight;
  }

  // Calls visit(first, count) for each run of wanted nodes.
  template <typename Visit>
  static void for_each_wanted(const Flight& flight, const Visit& visit) {
    const auto count = static_cast<NodeId>(flight.wanted.size());
    for (NodeId i = 0; i < count;) {
      NodeId end = i;
      while (end < count && flight.wanted[end]) ++end;
      if (end > i) visit(flight.first + i, end - i);
      i = end + 1;
    }
  }

  // Ends a run of nodes of a flight, but for those that are asked for again.
  void unpack(const Flight& flight, NodeId first, NodeId count) {
    const std::uint64_t begin = source_.stored(flight.first).place;
    for (NodeId n = first; n < first + count; ++n) {
      if (!is_image_whole(flight, n) && damaged_.insert(n).second) {
        wait_for(n, 1);
        continue;
      }
      const StoredMesh stored = source_.stored(n);
      const auto part =
          std::span(flight.parts[0].bytes).subspan(static_cast<std::size_t>(stored.place - begin), stored.bytes);
      MeshLoad load{n, stored.bytes, std::vector<MeshBytes>(1), std::vector<std::string>(1)};
      try {
        auto copy = std::make_unique_for_overwrite<std::byte[]>(part.size());
        std::ranges::copy(part, copy.get());
        load.meshes[0] = source_.unpack(n, std::move(copy));
      } catch (const Error& error) {
        if (damaged_.insert(n).second) {
          wait_for(n, 1);
          continue;
        }
        load.problems[0] = error.what();
      }
      ended_.push_back(std::move(load));
    }
  }

  [[nodiscard]] bool is_image_whole(const Flight& flight, NodeId n) const {
    const StoredImage image = source_.stored_image(n);
    if (image.bytes == 0) return true;
    const Part& part = flight.parts[1];
    const auto bytes =
        std::span(part.bytes).subspan(static_cast<std::size_t>(image.place - part.range.begin), image.bytes);
    return sections::checksum_of(bytes) == image.checksum;
  }

  MeshSource& source_;
  std::uint64_t place_;
  std::shared_ptr<RemoteBytes> bytes_;
  std::deque<MeshLoad> waiting_, ended_;
  Flights flights_;
  std::vector<std::uint32_t> cancelled_;
  std::set<NodeId> damaged_;  // have come damaged once
  std::uint32_t last_id_ = 0;
};

namespace {

using sections::FileHeader;
using sections::Section;

// What open() reads of a file. Other sections are not fetched: those of refinement within nodes, and what this program
// does not know.
constexpr std::array<std::string_view, 15> table_names = {"NODE", "PTCH", "CHIL", "ROOT", "LEVL",
                                                          "BLOK", "PMPL", "INFO", "LATT", "ORIG",
                                                          "MATE", "REPO", "LEFN", "NIMG", "IMAT"};
// Asked for at once with what is needed: a request costs more than so many bytes.
constexpr std::uint64_t worth_joining = 64U << 10U;

std::string_view name_of(const Section& section) { return {section.name.data(), section.name.size()}; }

// Joins ranges that nearly touch. Within the file.
std::vector<ByteRange> joined(std::vector<ByteRange> ranges, std::uint64_t size) {
  std::ranges::sort(ranges, {}, &ByteRange::begin);
  std::vector<ByteRange> result;
  for (const ByteRange& range : ranges) {
    const ByteRange inside{std::min(range.begin, size), std::min(range.end, size)};
    if (inside.begin >= inside.end) continue;
    if (!result.empty() && inside.begin <= result.back().end + worth_joining)
      result.back().end = std::max(result.back().end, inside.end);
    else
      result.push_back(inside);
  }
  return result;
}

// Finds out what opening a file needs, as far as what has come says: nothing of a file that will be refused.
class Needs {
 public:
  explicit Needs(RemoteBytes& bytes) : bytes_(bytes) {}

  [[nodiscard]] std::vector<ByteRange> missing() {
    const std::uint64_t size = bytes_.size();
    if (size < sizeof(FileHeader)) return {};
    const ByteRange head{0, sizeof(FileHeader)};
    FileHeader header{};
    if (!read(head, std::as_writable_bytes(std::span(&header, 1)))) return {{0, std::min(size, worth_joining)}};
    if (header.magic != ohlod::file_kind.magic || header.file_bytes != size ||
        header.section_count > sections::max_sections)
      return {};
    table_.resize(header.section_count);
    const ByteRange table{sizeof(header), sizeof(header) + table_.size() * sizeof(Section)};
    if (table.end > size) return {};
    if (!read(table, std::as_writable_bytes(std::span(table_)))) return {{0, std::max(table.end, worth_joining)}};
    if (sections::checksum_of(std::as_bytes(std::span(table_))) != header.table_checksum) return {};
    std::vector<ByteRange> ranges = {table};
    for (const std::string_view name : table_names)
      if (const Section* const section = find(name))
        ranges.push_back({section->offset, section->offset + section->bytes});
    // Coarse nodes come first, so some of the roots are probably among them.
    for (const std::string_view name : {ohlod::packed_meshes_name, ohlod::images_name})
      if (const Section* const section = find(name))
        ranges.push_back({section->offset, section->offset + std::min(section->bytes, worth_joining)});
    std::vector<ByteRange> missing = bytes_.missing(joined(std::move(ranges), size));
    return missing.empty() ? bytes_.missing(joined(roots(), size)) : missing;
  }

  // Where the meshes begin.
  [[nodiscard]] std::uint64_t place_of_meshes() const {
    const Section* const packed = find(ohlod::packed_meshes_name);
    const Section* const plain = find(ohlod::meshes_name);
    return packed != nullptr ? packed->offset : plain != nullptr ? plain->offset : 0;
  }

 private:
  [[nodiscard]] bool read(const ByteRange& range, std::span<std::byte> to) {
    if (!bytes_.missing({&range, 1}).empty() || range.end - range.begin != to.size()) return false;
    bytes_.read({&to, 1}, range.begin);
    return true;
  }

  [[nodiscard]] const Section* find(std::string_view name) const {
    const auto found = std::ranges::find(table_, name, name_of);
    return found == table_.end() ? nullptr : &*found;
  }

  // Elements of a section that has come; none where it is damaged, which opening the file will tell.
  template <typename Element>
  [[nodiscard]] std::vector<Element> elements(std::string_view name) {
    const Section* const section = find(name);
    if (section == nullptr || section->bytes > bytes_.size() || !olod::is_plausible(section->bytes, section->raw_bytes))
      return {};
    std::vector<std::byte> stored(static_cast<std::size_t>(section->bytes));
    if (!read({section->offset, section->offset + section->bytes}, stored)) return {};
    std::vector<Element> result(static_cast<std::size_t>(section->raw_bytes / sizeof(Element)));
    const auto raw = std::as_writable_bytes(std::span(result));
    if (section->codec == sections::Codec::zstd) {
      if (!olod::unpack(stored, sizeof(Element), raw)) return {};
    } else if (stored.size() == raw.size()) {
      std::ranges::copy(stored, raw.begin());
    }
    return result;
  }

  // Meshes of roots in a packed file, and images of roots. Others are asked for as reading them fails.
  [[nodiscard]] std::vector<ByteRange> roots() {
    const auto places = elements<std::uint64_t>(ohlod::mesh_places_name);
    const auto images = elements<NodeImage>(ohlod::node_images_name);
    const Section* const all_images = find(ohlod::images_name);
    std::vector<ByteRange> ranges;
    for (const NodeId root : elements<NodeId>("ROOT")) {
      if (std::size_t{root} + 1 < places.size())
        ranges.push_back({place_of_meshes() + places[root], place_of_meshes() + places[root + 1]});
      if (root < images.size() && all_images != nullptr)
        ranges.push_back(
            {all_images->offset + images[root].place, all_images->offset + images[root].place + images[root].bytes});
    }
    return ranges;
  }

  RemoteBytes& bytes_;
  std::vector<Section> table_;
};

}  // namespace

RemoteOhlod::RemoteOhlod(std::string name, std::uint64_t bytes)
    : name_(std::move(name)), bytes_(std::make_shared<RemoteBytes>(bytes)) {}
RemoteOhlod::~RemoteOhlod() = default;

void RemoteOhlod::put(std::uint64_t offset, std::span<const std::byte> bytes) { bytes_->put(offset, bytes); }

std::vector<ByteRange> RemoteOhlod::open(const CacheOptions& cache) {
  assert(!file_);
  Needs needs(*bytes_);
  if (std::vector<ByteRange> missing = needs.missing(); !missing.empty()) return missing;
  const auto make_queue = [&](MeshSource& source) {
    auto loads = std::make_unique<RemoteLoads>(source, needs.place_of_meshes(), bytes_);
    loads_ = loads.get();
    return loads;
  };
  try {
    file_ = ohlod::open_ohlod(bytes_, name_, cache,
                              {make_queue, [this](const std::string& problem) { dropped_images_.push_back(problem); }});
  } catch (const Error&) {
    const std::optional<ByteRange> lacking = bytes_->take_lacking();
    if (!lacking) throw;
    dropped_images_.clear();  // they are read again
    return joined({{lacking->begin, std::max(lacking->end, lacking->begin + worth_joining)}}, bytes_->size());
  }
  if (cache.load == LoadMode::async) bytes_->forget();
  return {};
}

std::optional<RemoteRequest> RemoteOhlod::next() { return loads_->next(); }
void RemoteOhlod::arrive(std::uint32_t id, std::span<const std::byte> bytes) { loads_->arrive(id, bytes); }
void RemoteOhlod::lose(std::uint32_t id) { loads_->lose(id); }
void RemoteOhlod::fail(std::uint32_t id, const std::string& problem) { loads_->fail(id, problem); }
std::vector<std::uint32_t> RemoteOhlod::take_cancelled() { return loads_->take_cancelled(); }
std::vector<std::string> RemoteOhlod::take_dropped_images() { return std::exchange(dropped_images_, {}); }

}  // namespace occlod::hlod
