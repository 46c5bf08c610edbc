// Refines the views of one command: always with the same backend, or with the effects that pay off in each view.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "backend.h"
#include "json_output.h"
#include "measurement.h"
#include "occlod/auto_refiner.h"
#include "occlod/refiner.h"
#include "occlod/scene.h"

namespace occlod::tool {

// Holds the options of `--occlusion auto`.
struct AutoWayOptions {
  std::filesystem::path calibration;       // to read; empty: measured
  std::filesystem::path save_calibration;  // to write; empty: not written
};

class RefineWay {
 public:
  // Uses AutoRefiner if options.occlusion is "auto". Throws Error like make_backend() and read_calibration().
  RefineWay(const std::vector<LoadedObject>& objects, const BackendOptions& options,
            const AutoWayOptions& auto_options);

  [[nodiscard]] std::string name() const;  // of the backend, or "auto"
  [[nodiscard]] const Json& gl() const { return gl_; }
  // Shows the backend what was drawn, if it is asked for pictures. Returns the milliseconds that takes.
  std::optional<double> show(const DepthBuffer& depth);
  // Repeats once more.
  void repeat(Measurement& measurement, const View& view, const RefineOptions& options);

  // Returns the options of the last view with the effects that were on; visibility() returns the backend that was used.
  [[nodiscard]] RefineOptions fixed(const RefineOptions& options) const;
  [[nodiscard]] Visibility& visibility();
  [[nodiscard]] const AutoRefiner* chooser() const { return auto_.get(); }  // null unless auto

 private:
  std::unique_ptr<Visibility> visibility_;
  SoftwareOcclusion* pictured_ = nullptr;  // visibility_, if it is to be shown pictures
  std::unique_ptr<AutoRefiner> auto_;
  NoOcclusion none_;
  Json gl_;
};

}  // namespace occlod::tool
