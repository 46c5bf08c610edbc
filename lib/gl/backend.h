// Checks the options that every OpenGL backend shares.
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

// Throws Error that names `user` when the context is null, flight is 0 or divisor is below 1.
void require_options(const Context* context, std::size_t flight, int divisor, const char* user);

// Batches queries that are answered together; gl-mark and gl-compute share it.

// Collects queries until the oldest answer is wanted, then sends all of them to the device at once.
class BatchedVisibility : public Visibility {
 public:
  [[nodiscard]] std::size_t flight() const noexcept final { return flight_; }
  void begin_view(const View& view, std::span<const ObjectView> objects) final;
  void draw_occluder(std::span<const OccluderPart> parts) final;
  void submit(const VisibilityQuery& query) final;
  [[nodiscard]] std::uint32_t collect() final;

 protected:
  explicit BatchedVisibility(std::size_t flight) : flight_(flight) {}

  virtual void start_view(const View& view, std::span<const ObjectView> objects) = 0;  // drops collected queries
  virtual void start_occluder(std::span<const OccluderPart> parts) = 0;
  // Returns the answer when it is known at once; otherwise collects the query.
  [[nodiscard]] virtual std::optional<std::uint32_t> ask(const VisibilityQuery& query) = 0;
  // Replaces `answers` by the answers to all collected queries, in their order, and drops the queries.
  virtual void answer_all(std::vector<std::uint32_t>& answers) = 0;

 private:
  std::deque<std::optional<std::uint32_t>> answers_;  // oldest first; empty for collected queries
  std::vector<std::uint32_t> batch_;
  std::size_t flight_;
};

// Owns a value that lives in a context and is destroyed there.

// Makes a T from (functions, arguments...) while the context is current, and destroys it while the context is current.
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
      // Deleting now would affect the objects of another context. Ours are freed with their context.
      static_cast<void>(value_.release());
    }
  }

  // Makes the context current and returns the value.
  [[nodiscard]] T& use() const {
    context_->make_current();
    return *value_;
  }
  // Returns the value without making the context current, for members that do not need it.
  [[nodiscard]] const T& look() const noexcept { return *value_; }

 private:
  std::shared_ptr<Context> context_;
  std::unique_ptr<T> value_;
};

// Reuses query objects and waits for their answers.

// Holds idle query objects of one target, because an object keeps the target of its first use. The context must be
// current in every call.
class QueryPool {
 public:
  explicit QueryPool(GLenum target) : target_(target) {}

  // Begins a query that counts what is drawn between begin() and end().
  [[nodiscard]] Query begin(const Functions& gl);
  void end(const Functions& gl) const { gl.EndQuery(target_); }
  // Returns whether the answer is available. Never waits, if the driver follows the specification.
  [[nodiscard]] static bool is_available(const Functions& gl, const Query& query);
  // Waits for the answer and recycles the object. Throws Error when there is none after 10 s, and ContextLost when the
  // context is lost meanwhile.
  [[nodiscard]] std::uint32_t take(const Functions& gl, Query query);
  // Recycles a query whose answer is no longer wanted.
  void drop(Query query) { idle_.push_back(std::move(query)); }

 private:
  GLenum target_;
  std::vector<Query> idle_;
};

}  // namespace occlod::gl
