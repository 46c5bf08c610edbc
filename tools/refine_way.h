// How the views of one command are refined: always by the same backend, or with the effects that pay in each view.
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

// `--occlusion auto`.
struct AutoWayOptions {
  std::filesystem::path calibration;       // read; empty = measured
  std::filesystem::path save_calibration;  // written; empty = not
};

class RefineWay {
 public:
  // With options.occlusion == "auto" by AutoRefiner. Throws Error as make_backend() and read_calibration() do.
  RefineWay(const std::vector<LoadedObject>& objects, const BackendOptions& options,
            const AutoWayOptions& auto_options);

  [[nodiscard]] std::string name() const;  // of the backend, or "auto"
  [[nodiscard]] const Json& gl() const { return gl_; }
  // One more repetition.
  void repeat(Measurement& measurement, const View& view, const RefineOptions& options);

  // What refined the last view: the same options with the effects that were on, and the backend that was asked.
  [[nodiscard]] RefineOptions fixed(const RefineOptions& options) const;
  [[nodiscard]] Visibility& visibility();
  [[nodiscard]] const AutoRefiner* chooser() const { return auto_.get(); }  // null unless auto

 private:
  std::unique_ptr<Visibility> visibility_;
  std::unique_ptr<AutoRefiner> auto_;
  NoOcclusion none_;
  Json gl_;
};

}  // namespace occlod::tool
