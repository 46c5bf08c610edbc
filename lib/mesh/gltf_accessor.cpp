#include "mesh/gltf_accessor.h"

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/file_input.h"

#ifdef OCCLOD_HAS_MESHOPTIMIZER
#include <meshoptimizer.h>
#endif

namespace occlod {
namespace {

// EXT_meshopt_compression is decoded by meshoptimizer, if the library is built with it.

// The properties that the extension gives to a buffer view.
struct MeshoptView {
  std::span<const std::uint8_t> bytes;  // compressed
  std::size_t count = 0;                // of elements
  std::size_t stride = 0;               // bytes of an element
  std::string mode;                     // ATTRIBUTES, TRIANGLES or INDICES
  std::string filter;                   // empty, NONE, OCTAHEDRAL, QUATERNION or EXPONENTIAL
};

#ifdef OCCLOD_HAS_MESHOPTIMIZER

constexpr const char* remedy = "export the mesh again, or without compression";

// False when the data are too short for that many elements: the codecs have a least size, so no memory is allocated for
// such a promise.
bool is_possible(const MeshoptView& view) {
  constexpr std::size_t max_bytes_of_one = 4096;
  const std::size_t bytes = view.bytes.size();
  if (view.mode == "TRIANGLES") return view.count % 3 == 0 && view.count / 3 <= bytes;
  if (view.mode == "INDICES") return view.count <= bytes;
  return view.count <= max_bytes_of_one * (bytes / view.stride + 1) && view.count <= max_bytes_of_one * bytes;
}

bool has_valid_layout(const MeshoptView& view) {
  if (view.mode == "ATTRIBUTES") return view.stride > 0 && view.stride % 4 == 0 && view.stride <= 256;
  return (view.mode == "TRIANGLES" || view.mode == "INDICES") && (view.stride == 2 || view.stride == 4);
}

// Returns false when the filter does not fit the elements.
bool unfilter(const MeshoptView& view, std::vector<std::uint8_t>& bytes) {
  if (view.filter.empty() || view.filter == "NONE") return true;
  if (view.mode != "ATTRIBUTES") return false;
  if (view.filter == "OCTAHEDRAL" && (view.stride == 4 || view.stride == 8)) {
    meshopt_decodeFilterOct(bytes.data(), view.count, view.stride);
  } else if (view.filter == "QUATERNION" && view.stride == 8) {
    meshopt_decodeFilterQuat(bytes.data(), view.count, view.stride);
  } else if (view.filter == "EXPONENTIAL") {
    meshopt_decodeFilterExp(bytes.data(), view.count, view.stride);
  } else {
    return false;
  }
  return true;
}

// Decodes to count * stride bytes. Throws Error at `place` for a mode or size that the extension does not allow, for
// data that are cut short or damaged, and always in a build without meshoptimizer.
[[nodiscard]] std::vector<std::uint8_t> decode_meshopt(const MeshoptView& view, const std::string& place,
                                                       const FileErrors& errors) {
  if (!has_valid_layout(view))
    errors.fail(place, "has a mode or byteStride that EXT_meshopt_compression does not know", remedy);
  if (!is_possible(view)) errors.fail(place, "promises more than its compressed bytes can hold", remedy);
  std::vector<std::uint8_t> bytes(view.count * view.stride);
  using Decoder = int (*)(void*, std::size_t, std::size_t, const unsigned char*, std::size_t);
  const auto decode = [&](Decoder function) {
    return function(bytes.data(), view.count, view.stride, view.bytes.data(), view.bytes.size()) == 0;
  };
  const bool done = view.count == 0             ? true
                    : view.mode == "ATTRIBUTES" ? decode(meshopt_decodeVertexBuffer)
                    : view.mode == "TRIANGLES"  ? decode(meshopt_decodeIndexBuffer)
                                                : decode(meshopt_decodeIndexSequence);
  if (!done) errors.fail(place, "has compressed bytes that are cut short or damaged", remedy);
  if (!unfilter(view, bytes)) errors.fail(place, "has a filter that does not fit its elements", remedy);
  return bytes;
}

#else

std::vector<std::uint8_t> decode_meshopt(const MeshoptView&, const std::string& place, const FileErrors& errors) {
  errors.fail(place, "is compressed with EXT_meshopt_compression, which this build does not read",
              "build occlod with meshoptimizer, or decompress the file: gltf-transform copy IN OUT");
}

#endif

constexpr const char* compression_name = "EXT_meshopt_compression";
constexpr const char* beyond = "reaches beyond its buffer: the file was cut or is malformed";

// True when `count` elements fit in `bytes` bytes.
bool fits(std::size_t bytes, std::size_t offset, std::size_t count, std::size_t stride, std::size_t size) {
  return offset <= bytes && (count == 0 || (size <= bytes - offset && count - 1 <= (bytes - offset - size) / stride));
}

std::size_t number_of(const tinygltf::Value& object, const char* key, const std::string& place,
                      const FileErrors& errors) {
  const tinygltf::Value& value = member(object, key);
  const double number = value.IsNumber() ? value.GetNumberAsDouble() : 0.0;
  if (!(number >= 0.0 && number <= 0x1p53))
    errors.fail(place, fmt::format("has a {} of {} in {}", key, number, compression_name), gltf_remedy);
  return static_cast<std::size_t>(number);
}

std::string text_of(const tinygltf::Value& object, const char* key) {
  const tinygltf::Value& value = member(object, key);
  return value.IsString() ? value.Get<std::string>() : std::string();
}

std::span<const std::uint8_t> buffer_of(const tinygltf::Model& model, std::size_t index, const std::string& place,
                                        const FileErrors& errors) {
  if (index >= model.buffers.size()) errors.fail(place, "has no buffer", gltf_remedy);
  return model.buffers[index].data;
}

}  // namespace

const tinygltf::Value& member(const tinygltf::Value& value, const std::string& key) {
  static const tinygltf::Value null;
  return value.IsObject() ? value.Get(key) : null;
}

int index_member(const tinygltf::Value& value, const std::string& key) {
  const tinygltf::Value& found = member(value, key);
  const double number = found.IsNumber() ? found.GetNumberAsDouble() : -1.0;
  return number >= 0.0 && number <= std::numeric_limits<int>::max() ? static_cast<int>(number) : -1;
}

GltfViews::View GltfViews::view(int index, const std::string& place) {
  if (index < 0 || static_cast<std::size_t>(index) >= model_.bufferViews.size())
    errors_.fail(place, "has no data", gltf_remedy);
  const tinygltf::BufferView& view = model_.bufferViews[static_cast<std::size_t>(index)];
  if (const auto found = view.extensions.find(compression_name); found != view.extensions.end()) {
    const std::vector<std::uint8_t>& bytes = decoded(index, found->second);
    return {bytes, bytes.size(), number_of(found->second, "byteStride", place, errors_)};
  }
  if (view.buffer < 0) errors_.fail(place, "has no buffer", gltf_remedy);
  const std::span<const std::uint8_t> bytes = buffer_of(model_, static_cast<std::size_t>(view.buffer), place, errors_);
  if (view.byteOffset > bytes.size()) errors_.fail(place, beyond, gltf_remedy);
  return {bytes.subspan(view.byteOffset), view.byteLength, view.byteStride};
}

const std::vector<std::uint8_t>& GltfViews::decoded(int index, const tinygltf::Value& compression) {
  const auto [found, is_new] = decoded_.try_emplace(index);
  if (!is_new) return found->second;
  const std::string place = fmt::format("buffer view {}", index);
  const auto number = [&](const char* key) { return number_of(compression, key, place, errors_); };
  const std::span<const std::uint8_t> buffer = buffer_of(model_, number("buffer"), place, errors_);
  const std::size_t offset = number("byteOffset"), length = number("byteLength");
  if (!fits(buffer.size(), offset, 1, 1, length)) errors_.fail(place, beyond, gltf_remedy);
  found->second = decode_meshopt({buffer.subspan(offset, length), number("count"), number("byteStride"),
                                  text_of(compression, "mode"), text_of(compression, "filter")},
                                 place, errors_);
  return found->second;
}

GltfAccessor::GltfAccessor(GltfViews& views, int index, int components) {
  const FileErrors& errors = views.errors();
  if (index < 0 || static_cast<std::size_t>(index) >= views.model().accessors.size())
    errors.fail("", fmt::format("refers to accessor {}, which is not there", index), gltf_remedy);
  const tinygltf::Accessor& accessor = views.model().accessors[static_cast<std::size_t>(index)];
  const std::string place = fmt::format("accessor {}", index);
  component_type_ = accessor.componentType;
  components_ = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type));
  if (components_ < components) errors.fail(place, "has too few components", gltf_remedy);
  const int size = tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(component_type_)) * components_;
  if (size <= 0) errors.fail(place, "has elements of unknown size", gltf_remedy);
  count_ = accessor.count;
  normalized_ = accessor.normalized;
  const bool is_sparse = accessor.sparse.isSparse;
  if (accessor.bufferView >= 0)
    read_base(views, accessor, static_cast<std::size_t>(size), place);
  else
    make_zeros(views, static_cast<std::size_t>(size), place);
  if (is_sparse) replace_sparse(views, accessor, static_cast<std::size_t>(size), place);
}

void GltfAccessor::read_base(GltfViews& views, const tinygltf::Accessor& accessor, std::size_t size,
                             const std::string& place) {
  const GltfViews::View view = views.view(accessor.bufferView, place);
  stride_ = view.stride == 0 ? size : view.stride;
  if (!fits(view.bytes.size(), accessor.byteOffset, count_, stride_, size))
    views.errors().fail(place, beyond, gltf_remedy);
  data_ = view.bytes.data() + accessor.byteOffset;
}

// An accessor without a buffer view holds zeros, which may not take more memory than the file.
void GltfAccessor::make_zeros(GltfViews& views, std::size_t size, const std::string& place) {
  std::size_t file_bytes = 0;
  for (const tinygltf::Buffer& buffer : views.model().buffers) file_bytes += buffer.data.size();
  if (count_ > file_bytes) views.errors().fail(place, fmt::format("has {} elements without data", count_), gltf_remedy);
  own_.assign(count_ * size, 0);
  data_ = own_.data();
  stride_ = size;
}

// Makes a packed copy of the elements.
void GltfAccessor::make_own(std::size_t size) {
  if (!own_.empty()) return;
  own_.assign(count_ * size, 0);
  for (std::size_t i = 0; i < count_; ++i) std::memcpy(own_.data() + i * size, data_ + i * stride_, size);
  data_ = own_.data();
  stride_ = size;
}

void GltfAccessor::replace_sparse(GltfViews& views, const tinygltf::Accessor& accessor, std::size_t size,
                                  const std::string& place) {
  const FileErrors& errors = views.errors();
  make_own(size);
  const auto& sparse = accessor.sparse;
  const auto count = static_cast<std::size_t>(std::max(sparse.count, 0));
  const auto index_type = sparse.indices.componentType;
  const std::size_t index_size = index_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE    ? 1
                                 : index_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ? 2
                                 : index_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT   ? 4
                                                                                        : 0;
  if (index_size == 0) errors.fail(place, "has sparse indices of an unknown type", gltf_remedy);
  const auto bytes_of = [&](int view_index, int offset, std::size_t element) {
    const std::span<const std::uint8_t> bytes = views.view(view_index, place).bytes;
    if (offset < 0 || !fits(bytes.size(), static_cast<std::size_t>(offset), count, element, element))
      errors.fail(place, beyond, gltf_remedy);
    return bytes.data() + offset;
  };
  const std::uint8_t* const indices = bytes_of(sparse.indices.bufferView, sparse.indices.byteOffset, index_size);
  const std::uint8_t* const values = bytes_of(sparse.values.bufferView, sparse.values.byteOffset, size);
  for (std::size_t i = 0; i < count; ++i) {
    std::uint32_t index = 0;  // little-endian, like this machine
    std::memcpy(&index, indices + i * index_size, index_size);
    if (index >= count_)
      errors.fail(place, fmt::format("has a sparse value for element {} of {}", index, count_), gltf_remedy);
    std::memcpy(own_.data() + index * size, values + i * size, size);
  }
}

}  // namespace occlod
