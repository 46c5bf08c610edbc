#include "refine_way.h"

#include <utility>

#include "drawing.h"
#include "occlod/base.h"
#include "refine/forecast.h"
#include "stopwatch.h"

namespace occlod::tool {
namespace {

std::unique_ptr<AutoRefiner> make_auto(const std::vector<LoadedObject>& objects, const AutoWayOptions& auto_options) {
  std::optional<Calibration> calibration;
  if (!auto_options.calibration.empty()) calibration = read_calibration(auto_options.calibration);
  auto refiner = std::make_unique<AutoRefiner>(refine_objects(objects), calibration);
  if (!auto_options.save_calibration.empty()) write_calibration(auto_options.save_calibration, refiner->calibration());
  return refiner;
}

}  // namespace

RefineWay::RefineWay(const std::vector<LoadedObject>& objects, const BackendOptions& options,
                     const AutoWayOptions& auto_options) {
  if (options.occlusion == "auto") {
    auto_ = make_auto(objects, auto_options);
    return;
  }
  if (!auto_options.calibration.empty() || !auto_options.save_calibration.empty())
    throw Error(
        {options.occlusion, "--calibration", "is not an option of this backend", "use it with --occlusion auto"});
  if (options.occlusion == "picture") {
    std::unique_ptr<SoftwareOcclusion> software = make_software_occlusion();
    pictured_ = software.get();
    visibility_ = std::move(software);
    return;
  }
  Backend backend = make_backend(options);
  visibility_ = std::move(backend.visibility);
  gl_ = std::move(backend.gl);
}

std::string RefineWay::name() const {
  if (auto_) return "auto";
  return pictured_ != nullptr ? "picture" : std::string(visibility_->name());
}

std::optional<double> RefineWay::show(const DepthBuffer& depth) {
  if (pictured_ == nullptr) return std::nullopt;
  const Stopwatch stopwatch;
  pictured_->show(depth);
  return stopwatch.milliseconds();
}

void RefineWay::repeat(Measurement& measurement, const View& view, const RefineOptions& options) {
  if (auto_)
    measurement.repeat(view, options, *auto_);
  else
    measurement.repeat(view, options, *visibility_);
}

RefineOptions RefineWay::fixed(const RefineOptions& options) const {
  std::shared_ptr<const Tuning> tuning;
  return auto_ ? with_choice(options, auto_->report().choice, tuning) : options;
}

Visibility& RefineWay::visibility() {
  if (!auto_) return *visibility_;
  const std::optional<std::size_t> backend = auto_->report().choice.backend;
  return backend ? auto_->backend(*backend) : none_;
}

}  // namespace occlod::tool
