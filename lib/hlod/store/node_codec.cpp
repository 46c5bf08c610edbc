#include "hlod/store/node_codec.h"

#include <zstd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <new>

#include "mesh/section_file.h"

namespace occlod::ohlod {
namespace {

constexpr int level = 3;  // higher levels gain some percent at many times the time

// Names a reversible transform of the elements that makes most bytes small before compression. It accepts any bits.
enum class Filter : std::uint8_t {
  none,
  positions,  // differences from the vertex before, as integers on a lattice or as floats
  floats,     // differences from the element before
  first_use,  // indices, as distances from the next unused one: most are 0 or small
  links,      // ids, as differences from the one before, or `stays`
};

// Describes an array of a node.
struct Stream {
  std::size_t first = 0, bytes = 0;  // in the raw bytes
  std::size_t element_bytes = 0;
  Filter filter = Filter::none;
};

// Returns the attribute arrays in the order in which they lie.
std::array<Stream, 5> vertex_streams(const hlod::VertexLayout& layout) {
  const auto stream = [](std::size_t first, std::size_t end, std::size_t element_bytes, Filter filter = Filter::none) {
    return Stream{first, end - first, element_bytes, filter};
  };
  return {stream(0, layout.normals, sizeof(glm::vec3), Filter::positions),
          stream(layout.normals, layout.colors, sizeof(glm::vec3)),
          stream(layout.colors, layout.texture_coordinates, sizeof(glm::u8vec4)),
          stream(layout.texture_coordinates, layout.materials, sizeof(glm::vec2)),
          stream(layout.materials, layout.end, sizeof(MaterialId))};
}

}  // namespace

// Lists the arrays of a node in the order in which they lie.
struct NodeStreams {
  std::array<Stream, 8> streams;  // absent arrays are empty
  std::size_t bytes = 0;          // without padding before the next node
};

namespace {

NodeStreams mesh_streams(const hlod::HlodView& view, hlod::NodeId n) {
  const hlod::MeshLayout layout(view.nodes[n], arrays_of(view));
  NodeStreams result{{}, layout.bytes};
  const auto rest = std::ranges::copy(vertex_streams(layout), result.streams.begin()).out;
  rest[0] = {layout.indices, layout.merged_into - layout.indices, 2, Filter::first_use};
  rest[1] = {layout.merged_into, layout.bytes - layout.merged_into, 2, Filter::links};
  return result;
}

NodeStreams splits_streams(const hlod::HlodView& view, hlod::NodeId n) {
  const hlod::SplitsLayout layout(view.within[n], arrays_of(view));
  NodeStreams result{{}, layout.bytes};
  const auto rest = std::ranges::copy(vertex_streams(layout), result.streams.begin()).out;
  rest[0] = {layout.errors, layout.indices - layout.errors, 4, Filter::floats};
  rest[1] = {layout.indices, layout.parents - layout.indices, 2, Filter::none};
  rest[2] = {layout.parents, layout.bytes - layout.parents, 2, Filter::links};
  return result;
}

template <typename T>
T load(const std::byte* from) {
  T value;
  std::memcpy(&value, from, sizeof(value));
  return value;
}

template <typename T>
void store(std::byte* to, T value) {
  std::memcpy(to, &value, sizeof(value));
}

// Maps small signed numbers to small unsigned ones: 0, -1, 1, -2 ... to 0, 1, 2, 3 ...
constexpr std::uint32_t zigzag(std::uint32_t x) { return (x << 1U) ^ (0U - (x >> 31U)); }
constexpr std::uint32_t unzigzag(std::uint32_t x) { return (x >> 1U) ^ (0U - (x & 1U)); }

// Maps the bits of a float to an integer that increases with it.
constexpr std::uint32_t ordered(std::uint32_t bits) { return bits ^ ((0U - (bits >> 31U)) >> 1U); }

// Coordinates that are whole multiples of a power of two become these multiples, so that differences do not depend on
// where exponents of floats change. A code is that exponent plus 127, in [1, 254]; 0 means no lattice.
using LatticeCode = std::uint8_t;

constexpr int code_offset = 127;

float step_of(LatticeCode code) { return std::ldexp(1.0F, int{code} - code_offset); }

// Returns the code of the coarsest lattice on which all coordinates are, bit for bit, multiples that floats count
// exactly.
LatticeCode lattice_of(std::span<const std::byte> floats) {
  constexpr std::uint32_t sign = 1U << 31U, mantissa_bits = 23, largest_exponent = 255;
  int finest = std::numeric_limits<int>::max(), largest = std::numeric_limits<int>::min();
  for (std::size_t i = 0; i < floats.size(); i += sizeof(float)) {
    const auto bits = load<std::uint32_t>(floats.data() + i);
    if (bits == 0) continue;
    const std::uint32_t exponent = (bits & ~sign) >> mantissa_bits;
    if (exponent == 0 || exponent == largest_exponent) return 0;  // -0, denormal or not finite
    const std::uint32_t mantissa = (bits & ((1U << mantissa_bits) - 1)) | (1U << mantissa_bits);
    const int last_bit = static_cast<int>(exponent) + std::countr_zero(mantissa) - static_cast<int>(mantissa_bits);
    finest = std::min(finest, last_bit);
    largest = std::max(largest, static_cast<int>(exponent));
  }
  if (finest > largest) return code_offset;  // all are 0
  if (finest < 1 || largest - finest >= static_cast<int>(mantissa_bits)) return 0;
  return static_cast<LatticeCode>(finest);
}

class NumberCoder {
 public:
  explicit NumberCoder(LatticeCode lattice) : lattice_(lattice), step_(lattice == 0 ? 1.0F : step_of(lattice)) {}

  [[nodiscard]] std::uint32_t number_of(std::uint32_t bits) const {
    return lattice_ == 0 ? ordered(bits)
                         : static_cast<std::uint32_t>(static_cast<std::int32_t>(std::bit_cast<float>(bits) / step_));
  }
  [[nodiscard]] std::uint32_t bits_of(std::uint32_t number) const {
    return lattice_ == 0 ? ordered(number)
                         : std::bit_cast<std::uint32_t>(static_cast<float>(static_cast<std::int32_t>(number)) * step_);
  }

 private:
  LatticeCode lattice_;
  float step_;
};

// Filters elements of several components of 4 bytes.
void filter_numbers(std::span<const std::byte> from, std::size_t element_bytes, LatticeCode lattice, std::byte* to) {
  const NumberCoder coder(lattice);
  for (std::size_t component = 0; component < element_bytes; component += 4) {
    std::uint32_t last = 0;
    for (std::size_t i = component; i < from.size(); i += element_bytes) {
      const std::uint32_t number = coder.number_of(load<std::uint32_t>(from.data() + i));
      store(to + i, zigzag(number - last));
      last = number;
    }
  }
}

void unfilter_numbers(std::span<std::byte> values, std::size_t element_bytes, LatticeCode lattice) {
  const NumberCoder coder(lattice);
  for (std::size_t component = 0; component < element_bytes; component += 4) {
    std::uint32_t last = 0;
    for (std::size_t i = component; i < values.size(); i += element_bytes) {
      last += unzigzag(load<std::uint32_t>(values.data() + i));
      store(values.data() + i, coder.bits_of(last));
    }
  }
}

using Index = std::uint16_t;

void filter_first_use(std::span<const std::byte> from, std::byte* to) {
  Index next = 0;
  for (std::size_t i = 0; i < from.size(); i += sizeof(Index)) {
    const auto back = static_cast<Index>(next - load<Index>(from.data() + i));
    store(to + i, back);
    next = static_cast<Index>(next + (back == 0 ? 1 : 0));
  }
}

void unfilter_first_use(std::span<std::byte> values) {
  Index next = 0;
  for (std::size_t i = 0; i < values.size(); i += sizeof(Index)) {
    const auto back = load<Index>(values.data() + i);
    store(values.data() + i, static_cast<Index>(next - back));
    next = static_cast<Index>(next + (back == 0 ? 1 : 0));
  }
}

// Ids other than `stays` form a ring, on which every difference has one size and one sign.
constexpr int ring = hlod::stays;

void filter_links(std::span<const std::byte> from, std::byte* to) {
  int last = 0;
  for (std::size_t i = 0; i < from.size(); i += sizeof(Index)) {
    const auto id = load<Index>(from.data() + i);
    int code = 0;
    if (id != hlod::stays) {
      int difference = (id - last + ring) % ring;
      if (difference > ring / 2) difference -= ring;
      code = 1 + (difference >= 0 ? 2 * difference : -2 * difference - 1);
      last = id;
    }
    store(to + i, static_cast<Index>(code));
  }
}

void unfilter_links(std::span<std::byte> values) {
  int last = 0;
  for (std::size_t i = 0; i < values.size(); i += sizeof(Index)) {
    const int code = int{load<Index>(values.data() + i)} - 1;
    if (code < 0) {
      store(values.data() + i, hlod::stays);
      continue;
    }
    const int difference = code % 2 == 0 ? code / 2 : -(code + 1) / 2;
    last = (last + difference + ring) % ring;
    store(values.data() + i, static_cast<Index>(last));
  }
}

void filter(const Stream& stream, std::span<const std::byte> from, LatticeCode lattice, std::byte* to) {
  switch (stream.filter) {
    case Filter::none:
      std::ranges::copy(from, to);
      return;
    case Filter::positions:
      filter_numbers(from, stream.element_bytes, lattice, to);
      return;
    case Filter::floats:
      filter_numbers(from, stream.element_bytes, 0, to);
      return;
    case Filter::first_use:
      filter_first_use(from, to);
      return;
    case Filter::links:
      filter_links(from, to);
      return;
  }
}

void unfilter(const Stream& stream, std::span<std::byte> values, LatticeCode lattice) {
  switch (stream.filter) {
    case Filter::none:
      return;
    case Filter::positions:
      unfilter_numbers(values, stream.element_bytes, lattice);
      return;
    case Filter::floats:
      unfilter_numbers(values, stream.element_bytes, 0);
      return;
    case Filter::first_use:
      unfilter_first_use(values);
      return;
    case Filter::links:
      unfilter_links(values);
      return;
  }
}

}  // namespace

struct NodePacker::Context {
  std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> zstd{ZSTD_createCCtx(), &ZSTD_freeCCtx};
};

NodePacker::NodePacker() : context_(std::make_unique<Context>()) {
  if (!context_->zstd) throw std::bad_alloc();
}

NodePacker::~NodePacker() = default;

void NodePacker::pack_mesh(const hlod::HlodView& view, hlod::NodeId n, LargeVector<std::byte>& out) {
  pack(mesh_streams(view, n), view.meshes.subspan(view.nodes[n].mesh), out);
}

void NodePacker::pack_splits(const hlod::HlodView& view, hlod::NodeId n, LargeVector<std::byte>& out) {
  if (view.within[n].splits > 0) pack(splits_streams(view, n), view.splits.subspan(view.within[n].place), out);
}

// Appends the code of the lattice, and then a zstd frame with separated bytes for each array that is not empty.
void NodePacker::pack(const NodeStreams& node, std::span<const std::byte> raw, LargeVector<std::byte>& out) {
  const std::size_t begin = out.size();
  const LatticeCode lattice = lattice_of(raw.first(node.streams[0].bytes));
  out.push_back(std::byte{lattice});
  for (const Stream& stream : node.streams) {
    if (stream.bytes == 0) continue;
    filtered_.resize(stream.bytes);
    planes_.resize(stream.bytes);
    filter(stream, raw.subspan(stream.first, stream.bytes), lattice, filtered_.data());
    olod::separate(filtered_, stream.element_bytes, planes_);
    frame_.resize(ZSTD_compressBound(stream.bytes));
    const std::size_t size =
        ZSTD_compressCCtx(context_->zstd.get(), frame_.data(), frame_.size(), planes_.data(), planes_.size(), level);
    if (ZSTD_isError(size) != 0) throw std::bad_alloc();  // with room for the worst case, nothing else can fail
    out.insert(out.end(), frame_.begin(), frame_.begin() + static_cast<std::ptrdiff_t>(size));
  }
  const std::size_t raw_bytes = hlod::align_mesh(node.bytes);
  out.resize(std::max(out.size(), begin + (raw_bytes + max_packing - 1) / max_packing));
}

struct NodeUnpacker::Context {
  std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> zstd{ZSTD_createDCtx(), &ZSTD_freeDCtx};
};

NodeUnpacker::NodeUnpacker() : context_(std::make_unique<Context>()) {
  if (!context_->zstd) throw std::bad_alloc();
}

NodeUnpacker::~NodeUnpacker() = default;

bool NodeUnpacker::unpack_mesh(const hlod::HlodView& view, hlod::NodeId n, std::span<const std::byte> packed,
                               std::span<std::byte> raw) {
  return unpack(mesh_streams(view, n), packed, raw);
}

bool NodeUnpacker::unpack_splits(const hlod::HlodView& view, hlod::NodeId n, std::span<const std::byte> packed,
                                 std::span<std::byte> raw) {
  return view.within[n].splits > 0 ? unpack(splits_streams(view, n), packed, raw) : packed.empty();
}

bool NodeUnpacker::unpack(const NodeStreams& node, std::span<const std::byte> packed, std::span<std::byte> raw) {
  if (packed.empty()) return false;
  const auto lattice = std::to_integer<LatticeCode>(packed[0]);
  if (lattice > 2 * code_offset) return false;
  packed = packed.subspan(1);
  std::size_t end = 0;
  for (const Stream& stream : node.streams) {
    if (stream.bytes == 0) continue;
    std::ranges::fill(raw.subspan(end, stream.first - end), std::byte{0});
    end = stream.first + stream.bytes;
    const std::size_t frame = ZSTD_findFrameCompressedSize(packed.data(), packed.size());
    planes_.resize(stream.bytes);
    if (ZSTD_isError(frame) != 0 ||
        ZSTD_decompressDCtx(context_->zstd.get(), planes_.data(), planes_.size(), packed.data(), frame) != stream.bytes)
      return false;
    const std::span<std::byte> values = raw.subspan(stream.first, stream.bytes);
    olod::join(planes_, stream.element_bytes, values);
    unfilter(stream, values, lattice);
    packed = packed.subspan(frame);
  }
  std::ranges::fill(raw.subspan(end), std::byte{0});
  return std::ranges::all_of(packed, [](std::byte b) { return b == std::byte{0}; });
}

}  // namespace occlod::ohlod
