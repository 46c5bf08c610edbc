#include "gl/backend.h"

#include <cassert>
#include <chrono>
#include <thread>
#include <utility>

#include "occlod/base.h"

namespace occlod::gl {

void require_options(const Context* context, std::size_t flight, int divisor, const char* user) {
  if (context == nullptr) throw Error({user, "", "has no OpenGL context", "make one with create_context()"});
  if (flight == 0) throw Error({user, "flight", "is 0", "use at least 1"});
  if (divisor < 1)
    throw Error({user, "divisor", "is " + std::to_string(divisor), "use 1 (the view's own size) or more"});
}

void BatchedVisibility::begin_view(const View& view, std::span<const ObjectView> objects) {
  answers_.clear();
  start_view(view, objects);
}

void BatchedVisibility::draw_occluder(std::span<const OccluderPart> parts) {
  assert(answers_.empty());
  start_occluder(parts);
}

void BatchedVisibility::submit(const VisibilityQuery& query) { answers_.push_back(ask(query)); }

std::uint32_t BatchedVisibility::collect() {
  assert(!answers_.empty());
  if (!answers_.front()) {
    answer_all(batch_);
    auto next = batch_.begin();
    for (std::optional<std::uint32_t>& answer : answers_)
      if (!answer) answer = *next++;
    assert(next == batch_.end());
  }
  const std::uint32_t oldest = *answers_.front();
  answers_.pop_front();
  return oldest;
}

namespace {

using Clock = std::chrono::steady_clock;

// Drivers answer within milliseconds; after this time they never will.
constexpr std::chrono::seconds longest_wait{10};
// Polls between two checks for a lost context; this many take a millisecond. A lost context should answer at once, but
// some drivers do not.
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
