// Reads the numbers of glTF files: accessors, plain and sparse, over buffer views, plain and compressed by
// meshoptimizer. Checks that they stay inside their buffers, which tinygltf does not.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "base/file_input.h"
#include "mesh/tinygltf.h"

namespace occlod {

inline constexpr const char* gltf_remedy = "export the mesh again";

// Returns a member of an object; a null value when it is not there, or `value` is no object.
[[nodiscard]] const tinygltf::Value& member(const tinygltf::Value& value, const std::string& key);
// Returns a member that is an integer of at least 0, or -1.
[[nodiscard]] int index_member(const tinygltf::Value& value, const std::string& key);

// Finds the bytes of buffer views and keeps those that had to be decoded. The model and the errors outlive it.
class GltfViews {
 public:
  GltfViews(const tinygltf::Model& model, const FileErrors& errors) : model_(model), errors_(errors) {}

  struct View {
    std::span<const std::uint8_t> bytes;  // from the view's beginning to the end of its buffer
    std::size_t length = 0;               // size of the view, which may exceed `bytes` in a damaged file
    std::size_t stride = 0;               // bytes between elements; 0: they are packed
  };
  // Returns a buffer view. `place` names in errors what needs it.
  [[nodiscard]] View view(int index, const std::string& place);

  [[nodiscard]] const tinygltf::Model& model() const { return model_; }
  [[nodiscard]] const FileErrors& errors() const { return errors_; }

 private:
  [[nodiscard]] const std::vector<std::uint8_t>& decoded(int index, const tinygltf::Value& compression);

  const tinygltf::Model& model_;
  const FileErrors& errors_;
  std::map<int, std::vector<std::uint8_t>> decoded_;  // by index of the view
};

// Reads the numbers of one accessor.
class GltfAccessor {
 public:
  // Opens an accessor. Throws Error when it has fewer than `components` components.
  GltfAccessor(GltfViews& views, int index, int components);
  GltfAccessor(const GltfAccessor&) = delete;
  GltfAccessor& operator=(const GltfAccessor&) = delete;

  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] int components() const { return components_; }

  // Returns component k of element i; normalized integers become fractions.
  [[nodiscard]] double value(std::size_t i, int k) const {
    switch (component_type_) {
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return fraction(load<std::uint8_t>(i, k));
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return fraction(load<std::uint16_t>(i, k));
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        return load<std::uint32_t>(i, k);
      case TINYGLTF_COMPONENT_TYPE_BYTE:
        return fraction(load<std::int8_t>(i, k));
      case TINYGLTF_COMPONENT_TYPE_SHORT:
        return fraction(load<std::int16_t>(i, k));
      case TINYGLTF_COMPONENT_TYPE_INT:
        return load<std::int32_t>(i, k);
      case TINYGLTF_COMPONENT_TYPE_FLOAT:
        return static_cast<double>(load<float>(i, k));
      default:
        return load<double>(i, k);
    }
  }

 private:
  // `size` is the number of bytes of an element.
  void read_base(GltfViews& views, const tinygltf::Accessor& accessor, std::size_t size, const std::string& place);
  void make_zeros(GltfViews& views, std::size_t size, const std::string& place);
  void make_own(std::size_t size);
  void replace_sparse(GltfViews& views, const tinygltf::Accessor& accessor, std::size_t size, const std::string& place);

  template <typename T>
  [[nodiscard]] T load(std::size_t i, int k) const {
    T x;
    std::memcpy(&x, data_ + i * stride_ + static_cast<std::size_t>(k) * sizeof(T), sizeof(T));
    return x;
  }

  template <typename T>
  [[nodiscard]] double fraction(T x) const {
    return normalized_ ? std::max(-1.0, static_cast<double>(x) / std::numeric_limits<T>::max())
                       : static_cast<double>(x);
  }

  const std::uint8_t* data_ = nullptr;
  std::vector<std::uint8_t> own_;  // the data of a sparse accessor, to which data_ points
  std::size_t count_ = 0;
  std::size_t stride_ = 0;
  int component_type_ = 0;
  int components_ = 0;
  bool normalized_ = false;
};

}  // namespace occlod
