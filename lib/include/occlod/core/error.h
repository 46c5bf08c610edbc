// The one exception type of the library, thrown for bad files, meshes, options and set-ups. Broken preconditions are
// assertions instead.
#pragma once

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

}  // namespace occlod
