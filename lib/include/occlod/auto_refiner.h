// What the parts of a frame cost on one machine, measured once: after Guthe, Balazs and Klein, "Near Optimal
// Hierarchical Culling: Performance Driven Use of Hardware Occlusion Queries" (2006), sec. 3.2, with the cost of
// refinement added.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "occlod/device_costs.h"
#include "occlod/refiner.h"
#include "occlod/visibility.h"

namespace occlod {

// Costs of one backend. Nanoseconds, finite, all > 0.
struct BackendCosts {
  std::string name;                   // Visibility::name()
  double occluder_triangle_ns = 0.0;  // for each triangle of an occluder
  double occluder_fragment_ns = 0.0;  // for each fragment of an occluder
  double occluder_pixel_ns = 0.0;     // for each pixel of the image and each occluder: cleared and reduced
  double query_ns = 0.0;              // for one of many queries, including what refinement does for it
  double latency_ns = 0.0;            // for one query that is waited for

  friend bool operator==(const BackendCosts&, const BackendCosts&) = default;
};

// Costs of refinement and drawing. Nanoseconds, finite, all > 0.
struct Calibration {
  double visit_ns = 0.0;       // refinement visits a node that is in the processor's caches
  double far_visit_ns = 0.0;   // refinement visits a node that is not
  double cone_ns = 0.0;        // a visit tests the normal cone too
  double split_ns = 0.0;       // a split is applied: two triangles
  double kept_split_ns = 0.0;  // frame to frame: an applied split is evaluated again
  double triangle_ns = 0.0;    // drawing one triangle into the item buffer; a program that draws otherwise sets its own
  double fragment_ns = 0.0;    // drawing one fragment, likewise
  std::vector<BackendCosts> backends;  // one for each name
  // Of what HLODs are drawn with, by hlod::measure_costs(); one for each name. Times >= 0. measure_calibration() leaves
  // it empty, and files may leave it out.
  std::vector<hlod::DeviceCosts> devices = {};

  friend bool operator==(const Calibration&, const Calibration&) = default;
};

// Measures refinement, drawing and each backend (none null) on a generated mesh, each number as the median of a few
// passes: some 150 ms on the CPU. Throws what a backend throws.
[[nodiscard]] Calibration measure_calibration(std::span<const std::unique_ptr<Visibility>> backends);

// Returns the costs of the device with this name. Throws Error that lists the names.
[[nodiscard]] const hlod::DeviceCosts& device_costs_of(const Calibration& calibration, std::string_view device);

// Throws Error that names the first number that is not finite or not larger than 0; of devices, below 0.
void check_calibration(const Calibration& calibration);

// Writes JSON, with every digit, so that reading gives the same calibration back.
[[nodiscard]] std::string calibration_json(const Calibration& calibration);
// Reads such a file. Throws Error that names the file and the JSON path of what is missing, unknown, repeated, no
// number or not positive.
[[nodiscard]] Calibration read_calibration(const std::filesystem::path& path);
// Writes such a file, beside `path` and renamed. Throws Error that names the file.
void write_calibration(const std::filesystem::path& path, const Calibration& calibration);

// Which effects are on in a view, and why.

// Which effects are on. The same choice, view, options and objects give the same mesh.
struct EffectChoice {
  std::optional<std::size_t> backend;  // index into those given; none where nothing is asked about occlusion
  std::vector<ObjectEffects> objects;  // by object

  friend bool operator==(const EffectChoice&, const EffectChoice&) = default;
};

// How much a mesh fills the image.
struct Coverage {
  double layers = 1.0;        // fragments for each pixel of the image
  double front_layers = 1.0;  // of these, of triangles that face the eye: only those are in occluders
  double front_share = 1.0;   // of the triangles, in [0, 1]
};

// How much of a view is hidden, estimated from a sample of what refinement without occlusion would visit.
struct HiddenShares {
  std::size_t visits = 0;      // nodes sampled
  std::size_t splits = 0;      // of these, splits that would be applied
  double visits_hidden = 0.0;  // share of the nodes that are below a hidden subtree, in [0, 1]
  double splits_hidden = 0.0;  // share of the splits whose subtree is hidden, in [0, 1]
  double stars_hidden = 0.0;   // share of the splits whose own star is hidden, in [splits_hidden, 1]
  double growth = 2.0;         // times as many splits that are not hidden down to half of the error; >= 1
  Coverage coverage;           // of the mesh that hides
};

// What queries of one backend are expected to cost and give. The smallest score is chosen.
struct EffectForecast {
  std::optional<std::size_t> backend;  // index into those given; none where nothing is asked
  double frame_ms = 0.0;               // refinement, occlusion and drawing
  double occlusion_ms = 0.0;           // of these, occluders and queries
  double error = 1.0;                  // relative to that without occlusion at the same budget
  // Time to error: the smaller the better.
  [[nodiscard]] double score() const noexcept { return frame_ms * error; }
};

// A frame as it is expected.
struct FrameForecast {
  double triangles = 0.0;  // of the refined mesh
  double ms = 0.0;         // refinement, occlusion and drawing
};

// What was chosen for a view and why.
struct EffectReport {
  EffectChoice choice;                    // what was on
  std::vector<EffectForecast> forecasts;  // of everything that could have been chosen; first without occlusion
  HiddenShares ahead;                     // sampled before refinement, hidden by a coarse mesh
  std::optional<HiddenShares> back;       // sampled after an earlier view, hidden by its refined mesh
  bool looked_ahead = false;              // `ahead` is of this view
  bool looked_back = false;               // `back` is of this view
  bool held = false;                      // another choice scores better, but not by enough: update() keeps the one
                                          // before, refine() queries nothing
  double look_ms = 0.0;                   // measured time of both samples in this view
  // What a frame without occlusion would take for the forecast error of the choice, to compare with chosen()->frame_ms.
  FrameForecast same_error_without;
  std::vector<ObjectEffectStats> objects;  // by object: what the tests did

  // Returns the forecast of the choice; null before the first view.
  [[nodiscard]] const EffectForecast* chosen() const noexcept {
    const auto found = std::find_if(forecasts.begin(), forecasts.end(), [this](const EffectForecast& forecast) {
      return forecast.backend == choice.backend;
    });
    return found == forecasts.end() ? nullptr : &*found;
  }
};

// Refinement that asks about occlusion only where that is expected to pay: the setting `auto`.

// A Refiner that learns from view to view. Its choices depend on the calibration and on counts, never on a clock: the
// same calibration, objects, views and options in the same order give the same meshes. One thread at a time.
class AutoRefiner {
 public:
  // Without a calibration it measures one, which takes some 150 ms. It chooses from `backends`, each with another name;
  // none: the software backend. Throws Error when a hierarchy or a backend is missing, when check_calibration() refuses
  // the calibration, or when it does not know a backend.
  explicit AutoRefiner(std::span<const RefineObject> objects, const std::optional<Calibration>& calibration = {},
                       std::vector<std::unique_ptr<Visibility>> backends = {});
  ~AutoRefiner();
  AutoRefiner(AutoRefiner&&) noexcept;
  AutoRefiner& operator=(AutoRefiner&&) noexcept;

  // Returns the calibration as given or measured, of the given backends in their order.
  [[nodiscard]] const Calibration& calibration() const noexcept;
  // Counts as Refiner::base_triangles() does.
  [[nodiscard]] std::size_t base_triangles() const noexcept;
  // Counts as Refiner::full_triangles() does.
  [[nodiscard]] std::size_t full_triangles() const noexcept;

  // Places an object as Refiner::set_transform() does.
  void set_transform(std::size_t object, const glm::dmat4& object_to_world);

  // Refines as Refiner::refine() does, with effects chosen for the view in place of options.effects, and of what
  // the method asks and draws. Throws Error likewise.
  const Refinement& refine(const View& view, const RefineOptions& options);
  // Goes on as Refiner::update() does, with effects chosen for each view; a change of effects does not start from
  // scratch. They stay the same while the same view and options are given again, and where another choice would be only
  // a little better. Normal cones stay on: they are tested many at a time.
  const Refinement& update(const View& view, const RefineOptions& options);

  // Gives the last result away as Refiner::take_result() does.
  [[nodiscard]] Refinement take_result();

  // Returns what Refiner::visibility_ages() does.
  [[nodiscard]] std::vector<std::uint32_t> visibility_ages(std::size_t object) const;

  // Returns the report about the last view; valid until the next call.
  [[nodiscard]] const EffectReport& report() const noexcept;
  // Returns the backend with this index, as EffectChoice::backend gives it.
  [[nodiscard]] Visibility& backend(std::size_t index) const noexcept;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace occlod
