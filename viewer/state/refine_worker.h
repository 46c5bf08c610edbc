// Refines on a thread of its own, so that the window answers while a large budget is being spent. OpenGL backends live
// on that thread, in contexts of their own.
#pragma once

#include <array>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "cells_side.h"
#include "hlod_devices.h"
#include "hlod_side.h"
#include "objects.h"
#include "occlod/auto_refiner.h"
#include "occlod/device_costs.h"
#include "occlod/node_store.h"
#include "occlod/refiner.h"
#include "raster/depth_pyramid.h"
#include "settings.h"

namespace occlod::viewer {

struct RefineJob {
  std::uint64_t number = 0;                // ascending
  std::shared_ptr<const Objects> objects;  // all are refined, shown or not
  Camera camera;
  RefineOptions options;  // the budget is raised to the base meshes where it is smaller
  Occlusion occlusion = Occlusion::software;
  bool frame_to_frame = true;  // go on from the mesh of the job before, by Refiner::update()
  bool from_scratch = false;   // but not from it: what comes depends on this job and those after it only
  bool again = false;          // one more frame of the same view: see RefinedFrame::goes_on
  bool compare = false;
  bool count_visible = true;
  bool keep_occluder = false;
  bool keep_seen = false;
  ColorBy color_by = ColorBy::plain;
  HlodSettings hlod;                       // where the objects are HLODs, instead of what is about meshes
  std::shared_ptr<const ViewCells> cells;  // of these objects, to walk through; null: refined
  CellSettings walk;
};

// Of Occlusion::automatic: what was on and why. The choice's backend is one of the calibration's.
struct Explanation {
  EffectReport report;
  Calibration calibration;
};

struct RefinedSide {
  Refinement refinement;                           // what was looked at to choose is part of refine_ms
  std::shared_ptr<const Explanation> explanation;  // of Occlusion::automatic
  std::uint64_t number = 0;   // of the refinement, ascending; the same where nothing was refined for the job
  std::uint64_t follows = 0;  // whose triangles its `changes` change; 0 = none
  std::optional<std::size_t> visible_triangles;       // that own a pixel, when asked for
  std::vector<std::vector<glm::u8vec4>> seen_colors;  // those of ColorBy::visibility, when asked for
  std::vector<std::vector<glm::u8vec4>> colors;       // by object and triangle; empty where colours tell nothing
  std::shared_ptr<const DepthPyramid> occluder;       // when asked for and one was drawn
};

// Immutable once it is handed over.
struct RefinedFrame {
  RefineJob job;
  // Either: as asked; with `compare` the same without occlusion, or by the other strategy, as well. With cells the
  // first side is what is drawn for the cell of the eye, that to compare with a refinement.
  std::vector<RefinedSide> sides;
  std::vector<HlodSide> hlod_sides;
  std::shared_ptr<const CellsFrame> cells;        // of the first side, where the job has cells
  std::optional<hlod::StoreStats> cache;          // after this frame, of HLODs whose meshes come and go
  std::optional<hlod::DeviceCosts> device_costs;  // of the device that HLODs are drawn on, where they are known
  std::uint64_t hash = 0;                         // of the first side
  // A limit has left work over, vertices slide, other nodes may be drawn, or a cell or meshes are on their way: one
  // more frame is worth its while.
  bool goes_on = false;
  std::string error;  // one line; then there are no sides

  [[nodiscard]] std::size_t side_count() const { return sides.size() + hlod_sides.size(); }
};

// Makes a backend, on the worker's thread. Throws Error when this machine has none such.
using MakeVisibility = std::function<std::unique_ptr<Visibility>(Occlusion)>;

class RefineWorker {
 public:
  // `calibration`: for Occlusion::automatic and strategies that need to know what the device costs; what it lacks is
  // measured when it is asked for first.
  explicit RefineWorker(MakeVisibility make_visibility, std::optional<Calibration> calibration = {},
                        MakeDevice make_device = make_portable_device);
  RefineWorker(const RefineWorker&) = delete;
  RefineWorker& operator=(const RefineWorker&) = delete;
  ~RefineWorker();

  // Replaces a job that has not been begun, but for its `from_scratch`.
  void request(RefineJob job);
  // The last frame that was finished; null before the first.
  [[nodiscard]] std::shared_ptr<const RefinedFrame> latest() const;
  // Waits until the frame of job `number`, or a later one, is finished, or the time is over.
  void wait_for(std::uint64_t number, double milliseconds) const;

 private:
  void run();

  MakeVisibility make_visibility_;
  MakeDevice make_device_;
  std::optional<Calibration> calibration_;
  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  std::optional<RefineJob> next_;
  std::shared_ptr<const RefinedFrame> latest_;
  bool end_ = false;
  std::thread thread_;
};

}  // namespace occlod::viewer
