#include "gl/query_pool.h"

#include <chrono>
#include <thread>
#include <utility>

#include "occlod/core/error.h"

namespace occlod::gl {
namespace {

using Clock = std::chrono::steady_clock;

// Drivers answer within milliseconds; after this long they never will.
constexpr std::chrono::seconds longest_wait{10};
// A lost context should answer at once; this is for drivers that do not. So many polls take a millisecond.
constexpr int looks_for_each_check = 1024;

void wait_for(const Functions& gl, const Query& query) {
  if (QueryPool::is_available(gl, query)) return;
  gl.Flush();
  const auto deadline = Clock::now() + longest_wait;
  for (int looks = 1;; ++looks) {
    if (QueryPool::is_available(gl, query)) return;
    if (Clock::now() > deadline)
      throw Error(
          {"OpenGL", "occlusion query", "the driver gave no answer", "use another driver, or the software backend"});
    if (looks % looks_for_each_check == 0) check(gl, "occlusion query");
    std::this_thread::yield();
  }
}

}  // namespace

Query QueryPool::begin(const Functions& gl) {
  if (idle_.empty()) idle_.emplace_back(gl);
  Query query = std::move(idle_.back());
  idle_.pop_back();
  gl.BeginQuery(target_, query.id());
  return query;
}

bool QueryPool::is_available(const Functions& gl, const Query& query) {
  GLuint available = GL_FALSE;
  gl.GetQueryObjectuiv(query.id(), GL_QUERY_RESULT_AVAILABLE, &available);
  return available == GL_TRUE;
}

std::uint32_t QueryPool::take(const Functions& gl, Query query) {
  wait_for(gl, query);
  GLuint passed = 0;
  gl.GetQueryObjectuiv(query.id(), GL_QUERY_RESULT, &passed);
  idle_.push_back(std::move(query));
  return passed;
}

}  // namespace occlod::gl
