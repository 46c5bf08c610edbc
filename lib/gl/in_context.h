// What lives in a context, ended there.
#pragma once

#include <memory>
#include <utility>

#include "occlod/core/error.h"
#include "occlod/gl/context.h"

namespace occlod::gl {

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

}  // namespace occlod::gl
