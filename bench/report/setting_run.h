// One setting at work in one scene.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "accuracy.h"
#include "measurement.h"
#include "occlod/visibility.h"
#include "report/settings.h"
#include "report/sweep.h"

namespace occlod::bench {

[[nodiscard]] std::unique_ptr<Visibility> make_visibility(const Setting& setting);

// Settings with the same text hide the same in refinements to a tolerance without a budget.
[[nodiscard]] std::string what_hides(const Setting& setting);

class SettingRun {
 public:
  // The setting outlives it.
  SettingRun(const Setting& setting, std::vector<LoadedObject> objects);
  SettingRun(const SettingRun&) = delete;
  SettingRun& operator=(const SettingRun&) = delete;
  ~SettingRun() = default;

  // The first frame of a burst, a jump: without a work limit, and not timed.
  void start(const View& view);
  void next(const View& view);
  // next(), and measures the picture and how it pops.
  void next(const View& view, const tool::FullMeshPicture& full);
  // Of the last picture.
  void set_wrongly_hidden(double pixels) { pictures_.back()[wrongly_hidden_measure] = pixels; }

  [[nodiscard]] const Setting& setting() const { return setting_; }
  [[nodiscard]] const tool::Measurement& measurement() const { return measurement_; }
  [[nodiscard]] Outcome outcome() const;

 private:
  void record();

  const Setting& setting_;
  std::vector<LoadedObject> objects_;
  tool::Measurement measurement_;
  std::unique_ptr<Visibility> visibility_;
  std::vector<double> refine_ms_, occlusion_ms_, ms_, draw_ms_, triangles_;
  std::vector<Measured> pictures_;
  std::uint64_t hash_ = 0;
};

}  // namespace occlod::bench
