// How often nodes turn out hidden when they are asked about, by what the model of cover says of them.
#pragma once

#include <array>
#include <cstddef>

namespace occlod::hlod {

// The model of Guthe and others 2006 takes what is drawn for rectangles at random places. Real scenes are a row of
// houses or an engine under its hood, so its probabilities are used for order only: nodes of about the same probability
// share a rate, which answers correct.
class HidingRates {
 public:
  void begin_frame();
  // A node that was visible when it was asked about last, `frames` ago.
  void note_visible(double cover_probability, double frames, bool hidden);
  // A node of which nothing was known.
  void note_new(double cover_probability, bool hidden);

  // How probable it is that a visible node is hidden in the next frame.
  [[nodiscard]] double of_visible(double cover_probability) const;
  // How probable it is that a node of which nothing is known is hidden.
  [[nodiscard]] double of_new(double cover_probability) const;

 private:
  static constexpr std::size_t classes = 8;
  struct Count {
    double hidden = 0.0;
    double all = 0.0;
  };
  [[nodiscard]] static std::size_t class_of(double cover_probability);

  std::array<Count, classes> visible_;  // all: frames
  std::array<Count, classes> new_;      // all: nodes
};

}  // namespace occlod::hlod
