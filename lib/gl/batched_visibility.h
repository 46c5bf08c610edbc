// Questions that are answered together: what gl-mark and gl-compute share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "occlod/refine/visibility.h"

namespace occlod::gl {

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

}  // namespace occlod::gl
