// A grid of voxels, and the largest blocks of those that are free.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace occlod {

// A small grid of voxels, some of them taken.
class VoxelGrid {
 public:
  using Place = std::array<int, 3>;
  // Voxels from `first` to before `end`, in each axis.
  struct Block {
    Place first{}, end{};
  };

  // Clears it.
  void resize(const Place& size);
  [[nodiscard]] const Place& size() const noexcept { return size_; }

  void take(const Place& p) { taken_[index(p)] = 1; }
  [[nodiscard]] bool is_taken(const Place& p) const { return taken_[index(p)] != 0; }
  // The largest cube without taken voxels, the last in order of x, y and z among equals; then as many layers at each
  // side as are free. Its voxels are given away: no later block starts with them, though it may grow over them.
  // Nothing where no voxel is left. O(voxels).
  [[nodiscard]] std::optional<Block> next_block();

 private:
  [[nodiscard]] std::size_t index(const Place& p) const {
    return (static_cast<std::size_t>(p[2]) * static_cast<std::size_t>(size_[1]) + static_cast<std::size_t>(p[1])) *
               static_cast<std::size_t>(size_[0]) +
           static_cast<std::size_t>(p[0]);
  }
  [[nodiscard]] std::optional<Block> largest_cube();
  [[nodiscard]] bool is_free(const Block& block) const;
  void grow(Block& block) const;

  Place size_{};
  std::vector<std::uint8_t> taken_;  // of voxels
  std::vector<std::uint8_t> given_;  // to earlier blocks
  std::vector<std::uint8_t> edge_;   // of the largest free cube that ends with the voxel
};

}  // namespace occlod
