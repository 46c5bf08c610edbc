// Lists the backends that one suite runs on: software occlusion, and gl-query with each kind of target.
#pragma once

#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "gl/support.h"

namespace occlod::gl {

enum class Backend { software, query, query_conservative, query_half, query_third };

struct TestedBackend {
  Backend backend = Backend::software;
  Platform platform = Platform::egl;  // means nothing to software

  [[nodiscard]] std::string label() const;  // "query_egl"
  // Returns whether it asks with grown volumes instead of exact rectangles, which is looser.
  [[nodiscard]] bool draws_proxies() const { return backend != Backend::software; }
  // Returns the pixels of the view for one sample in each direction.
  [[nodiscard]] int divisor() const {
    return backend == Backend::query_half ? 2 : backend == Backend::query_third ? 3 : 1;
  }
  // Returns null for software, and with the reason in `why` where the machine has no such context or too old a one.
  [[nodiscard]] std::shared_ptr<Context> context(std::string& why) const;
  [[nodiscard]] std::unique_ptr<Visibility> make(std::shared_ptr<Context> context, bool count_pixels = false) const;
};
std::ostream& operator<<(std::ostream& out, const TestedBackend& tested);

[[nodiscard]] std::vector<TestedBackend> tested_backends();
// Returns the same without software occlusion.
[[nodiscard]] std::vector<TestedBackend> tested_gl_backends();

// Gives a suite one context a test, and skips the test where the machine has none.
class EachBackend : public testing::TestWithParam<TestedBackend> {
 protected:
  void SetUp() override;
  [[nodiscard]] std::unique_ptr<Visibility> make(bool count_pixels = false) const {
    return GetParam().make(context_, count_pixels);
  }
  // Starts a view with one object and one part of an occluder.
  void start(Visibility& visibility, const Soup& occluder, const glm::dmat4& transform = glm::dmat4(1.0)) const;

  View view_ = test_view();
  std::shared_ptr<Context> context_;
};

inline const auto backend_label = [](const auto& param) { return param.param.label(); };

}  // namespace occlod::gl
