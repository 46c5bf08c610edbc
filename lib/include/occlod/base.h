// Errors, ids, the memory limit and the version: what every other header uses. Error is the only exception type of the
// library. It is thrown for bad files, meshes, options and set-ups; broken preconditions are assertions instead.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>

namespace occlod {

// An error message in the four parts that a user needs. UTF-8, without line breaks.
struct Diagnosis {
  std::string subject;  // the file or object, e.g. "bunny.ply"
  std::string place;    // where in it, e.g. "line 12" or "vertex 4711"; may be empty
  std::string problem;  // e.g. "x is not a number"
  std::string remedy;   // e.g. "export the mesh again"; may be empty
};

// The exception of the library. what() is one line: "subject: place: problem; remedy".
class Error : public std::runtime_error {
 public:
  // Composes what() from the four parts.
  explicit Error(Diagnosis diagnosis);
  // Returns the four parts, for programs that show them in their own way.
  [[nodiscard]] const Diagnosis& diagnosis() const noexcept { return diagnosis_; }

 private:
  Diagnosis diagnosis_;
};

// Ids are plain integers that index plain arrays.

using VertexId = std::uint32_t;    // indexes TriangleMesh::positions or Hierarchy::positions()
using SplitId = std::uint32_t;     // indexes HierarchyView::nodes, from coarse to fine; a split depends on smaller ids
                                   // only
using WedgeId = std::uint32_t;     // indexes TriangleMesh::positions or Hierarchy::positions(): a vertex with its
                                   // attributes
using MaterialId = std::uint16_t;  // indexes TriangleMesh::materials or HierarchyView::materials
using TextureId = std::uint16_t;   // indexes TriangleMesh::textures or HierarchyView::textures

// Means "no vertex" or "no split".
inline constexpr std::uint32_t no_id = std::numeric_limits<std::uint32_t>::max();
// Means "no texture".
inline constexpr TextureId no_texture = std::numeric_limits<TextureId>::max();

// Limits the main memory of builds from meshes that are larger than memory. While one lives, arrays of some megabytes
// that the library makes are stored in unnamed files in a folder, and a thread watches how much main memory the process
// has: whenever that comes near `bytes`, all pages of these files leave main memory. Pages that are touched again come
// back from the system's cache or from the disk. Results never depend on the limit. A file is removed with its array,
// and when the process ends, however it ends.
//
// Meant for build_hlod() from a TriangleSource, which reads and writes its arrays in order or near the last access.
// Small arrays and the program's own memory stay in main memory, so `bytes` has to leave room for them: an HLOD takes
// about half a byte there for each triangle of its input. Linux only; at most one at a time in a process.
class MemoryLimit {
 public:
  // `bytes` >= 2^26 limits all memory of the process. Throws Error for less, where the system does not tell how much
  // memory a process has, for a folder in which no files can be made, and while another limit lives. While it lives,
  // building throws Error when the folder's disk is full.
  MemoryLimit(std::size_t bytes, const std::filesystem::path& folder);
  ~MemoryLimit();
  MemoryLimit(const MemoryLimit&) = delete;
  MemoryLimit& operator=(const MemoryLimit&) = delete;

  // Returns the largest total size of the files so far, bytes.
  [[nodiscard]] std::size_t max_scratch_bytes() const noexcept;

 private:
  class Watch;
  std::unique_ptr<Watch> watch_;
};

// Returns the version of the linked library, "MAJOR.MINOR.PATCH", in static storage.
[[nodiscard]] const char* version() noexcept;

}  // namespace occlod
