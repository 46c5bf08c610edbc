// Query objects that are used again, and waiting for their answers.
#pragma once

#include <cstdint>
#include <vector>

#include "gl/objects.h"

namespace occlod::gl {

// Idle query objects of one target: an object keeps the target of its first use. Their context is current in every
// call.
class QueryPool {
 public:
  explicit QueryPool(GLenum target) : target_(target) {}

  // What is drawn between begin() and end() is counted.
  [[nodiscard]] Query begin(const Functions& gl);
  void end(const Functions& gl) const { gl.EndQuery(target_); }
  // Never waits, as far as the driver holds to that.
  [[nodiscard]] static bool is_available(const Functions& gl, const Query& query);
  // Waits for the answer; the object may then be used again. Throws Error when there is none after 10 s, and
  // ContextLost when the context is lost meanwhile.
  [[nodiscard]] std::uint32_t take(const Functions& gl, Query query);
  // For a query whose answer nobody wants any more.
  void drop(Query query) { idle_.push_back(std::move(query)); }

 private:
  GLenum target_;
  std::vector<Query> idle_;
};

}  // namespace occlod::gl
