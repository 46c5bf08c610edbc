#include "mesh/decode_meshopt.h"

#ifdef OCCLOD_HAS_MESHOPTIMIZER
#include <meshoptimizer.h>
#endif

namespace occlod {

#ifdef OCCLOD_HAS_MESHOPTIMIZER
namespace {

constexpr const char* remedy = "export the mesh again, or without compression";

// The codecs spend at least so much: a larger promise is not believed, and no memory taken for it.
bool is_possible(const MeshoptView& view) {
  constexpr std::size_t most_bytes_of_one = 4096;
  const std::size_t bytes = view.bytes.size();
  if (view.mode == "TRIANGLES") return view.count % 3 == 0 && view.count / 3 <= bytes;
  if (view.mode == "INDICES") return view.count <= bytes;
  return view.count <= most_bytes_of_one * (bytes / view.stride + 1) && view.count <= most_bytes_of_one * bytes;
}

bool has_valid_layout(const MeshoptView& view) {
  if (view.mode == "ATTRIBUTES") return view.stride > 0 && view.stride % 4 == 0 && view.stride <= 256;
  return (view.mode == "TRIANGLES" || view.mode == "INDICES") && (view.stride == 2 || view.stride == 4);
}

// False where the filter does not fit the elements.
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

}  // namespace

std::vector<std::uint8_t> decode_meshopt(const MeshoptView& view, const std::string& place, const FileErrors& errors) {
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

}  // namespace occlod
