// The one exception type of the library, thrown for bad files, meshes, options and set-ups. Broken preconditions are
// assertions instead.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>

namespace occlod {

// What went wrong, in the four parts that a user needs. UTF-8, without line breaks.
struct Diagnosis {
  std::string subject;  // the file or object, e.g. "bunny.ply"
  std::string place;    // where in it, e.g. "line 12" or "vertex 4711"; may be empty
  std::string problem;  // e.g. "x is not a number"
  std::string remedy;   // e.g. "export the mesh again"; may be empty
};

// what() is one line: "subject: place: problem; remedy".
class Error : public std::runtime_error {
 public:
  // Composes what() from the four parts.
  explicit Error(Diagnosis diagnosis);
  // The four parts, for programs that show them in their own way.
  [[nodiscard]] const Diagnosis& diagnosis() const noexcept { return diagnosis_; }

 private:
  Diagnosis diagnosis_;
};

// Index types shared by every layer. Plain integers: they index plain arrays.

using VertexId = std::uint32_t;  // into TriangleMesh::positions or Hierarchy::positions()
using SplitId = std::uint32_t;   // into HierarchyView::nodes, from coarse to fine; a split depends on smaller ids only
using WedgeId = std::uint32_t;   // into TriangleMesh::positions or Hierarchy::positions(): a vertex with its attributes
using MaterialId = std::uint16_t;  // into TriangleMesh::materials or HierarchyView::materials
using TextureId = std::uint16_t;   // into TriangleMesh::textures or HierarchyView::textures

// "No vertex" or "no split".
inline constexpr std::uint32_t no_id = std::numeric_limits<std::uint32_t>::max();
// "No texture".
inline constexpr TextureId no_texture = std::numeric_limits<TextureId>::max();

// A limit for builds of meshes larger than memory.

// While one lives, arrays of some megabytes that the library makes lie in files without names in a folder, and a thread
// watches how much main memory the process has: whenever that comes near `bytes`, all pages of these files leave it.
// What is touched again comes back from the system's cache or from the disk. What is built never depends on it. Files
// go when their arrays do, and when the process ends, however it ends.
//
// Meant for build_hlod() from a TriangleSource: its arrays are read and written in order, or near where they were read
// last. Small arrays and whatever the program has beside stay in memory, so `bytes` has to leave room for them: an HLOD
// takes about half a byte for each triangle of its input that way. Linux only; one at a time in a process.
class MemoryLimit {
 public:
  // bytes >= 2^26, of all the process has. Throws Error for less, where the system does not tell how much a process
  // has, for a folder that takes no files, and where there is a limit already. While it lives, building throws Error
  // when the folder's disk is full.
  MemoryLimit(std::size_t bytes, const std::filesystem::path& folder);
  ~MemoryLimit();
  MemoryLimit(const MemoryLimit&) = delete;
  MemoryLimit& operator=(const MemoryLimit&) = delete;

  // The most that all files together have had at a time.
  [[nodiscard]] std::size_t max_scratch_bytes() const noexcept;

 private:
  class Watch;
  std::unique_ptr<Watch> watch_;
};

// The version of the library, set by the build.

// "MAJOR.MINOR.PATCH", of the library that is linked. Static storage.
[[nodiscard]] const char* version() noexcept;

}  // namespace occlod
