// Keeps the images of nodes that are made, so that making them goes on where it was interrupted.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "hlod/build/journal_records.h"
#include "occlod/hlod.h"

namespace occlod::hlod {

// The coordinates of all vertices and the encoded image of a node; empty where it shows no divided image.
struct ImagePart {
  std::vector<std::byte> bytes;
  double texel_size = 0.0;
};

// The caller first takes what the file has, in the order of the nodes, and then appends the rest.
class ImageJournal {
 public:
  // Opens the file, or creates it. What it has of other nodes, other images or another version of the program is
  // removed. Throws Error that names the file when another build uses it, or it is no journal of images, or damaged
  // image files. O(bytes of nodes and images).
  ImageJournal(const std::filesystem::path& path, const Hlod& hlod, const std::filesystem::path& image_folder);

  // Reads the part of the next node. Returns false when the file has none; from then on all calls must append.
  [[nodiscard]] bool take(ImagePart& part);
  // Appends the part of the next node. It survives the process, but perhaps not a system crash.
  void append(const ImagePart& part);

 private:
  JournalRecords records_;
  bool all_taken_ = false;
  std::vector<std::byte> bytes_;  // one record
};

}  // namespace occlod::hlod
