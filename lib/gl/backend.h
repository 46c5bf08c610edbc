// What every OpenGL backend refuses.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "gl/objects.h"
#include "occlod/base.h"
#include "occlod/gl.h"
#include "occlod/visibility.h"

namespace occlod::gl {

// Throws Error that names `user` for no context, a flight of 0 or a divisor below 1.
void require_options(const Context* context, std::size_t flight, int divisor, const char* user);

// Questions that are answered together: what gl-mark and gl-compute share.

// Questions gather until the oldest answer is wanted; then all of them are put to the device at once.
class BatchedVisibility : public Visibility {
 public:
  [[nodiscard]] std::size_t flight() const noexcept final { return flight_; }
  void begin_view(const View& view, std::span<const ObjectView> objects) final;
  void draw_occluder(std::span<const OccluderPart> parts) final;
  void submit(const VisibilityQuery& query) final;
  [[nodiscard]] std::uint32_t collect() final;

 protected:
  explicit BatchedVisibility(std::size_t flight) : flight_(flight) {}

  virtual void start_view(const View& view, std::span<const ObjectView> objects) = 0;  // forgets what has gathered
  virtual void start_occluder(std::span<const OccluderPart> parts) = 0;
  // The answer when it is known at once; else the question gathers.
  [[nodiscard]] virtual std::optional<std::uint32_t> ask(const VisibilityQuery& query) = 0;
  // Replaces `answers` by those to all questions that have gathered, in their order, and forgets these.
  virtual void answer_all(std::vector<std::uint32_t>& answers) = 0;

 private:
  std::deque<std::optional<std::uint32_t>> answers_;  // oldest first; those that gather have none yet
  std::vector<std::uint32_t> batch_;
  std::size_t flight_;
};

// What lives in a context, ended there.

// A T made of (functions, arguments...) while the context is current, and destroyed so.
template <class T>
class InContext {
 public:
  template <class... Arguments>
  explicit InContext(std::shared_ptr<Context> context, Arguments&&... arguments) : context_(std::move(context)) {
    context_->make_current();
    value_ = std::make_unique<T>(context_->functions(), std::forward<Arguments>(arguments)...);
  }
  InContext(const InContext&) = delete;
  InContext(InContext&&) = delete;
  InContext& operator=(const InContext&) = delete;
  InContext& operator=(InContext&&) = delete;
  ~InContext() {
    try {
      context_->make_current();
    } catch (const Error&) {
      // Deleting now would hit the objects of another context. Ours end with the context.
      static_cast<void>(value_.release());
    }
  }

  // The value, with the context current.
  [[nodiscard]] T& use() const {
    context_->make_current();
    return *value_;
  }
  // The value for what needs no context.
  [[nodiscard]] const T& look() const noexcept { return *value_; }

 private:
  std::shared_ptr<Context> context_;
  std::unique_ptr<T> value_;
};

// Query objects that are used again, and waiting for their answers.

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
