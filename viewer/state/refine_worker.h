// Refines on its own thread, so that the window responds while a large budget is being spent. OpenGL backends live on
// that thread, in their own contexts.
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
#include "full_mesh.h"
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
  RefineOptions options;  // the budget is raised to that of the base meshes if it is smaller
  Occlusion occlusion = Occlusion::software;
  bool frame_to_frame = true;  // continue from the mesh of the last job, by Refiner::update()
  bool from_scratch = false;   // but not from that mesh: results depend on this job and later ones only
  bool again = false;          // one more frame of the same view: see RefinedFrame::goes_on
  bool compare = false;
  Beside beside = Beside::other;  // of meshes that are compared, without cells
  bool count_visible = true;
  bool keep_occluder = false;
  bool keep_seen = false;
  ColorBy color_by = ColorBy::plain;
  HlodSettings hlod;                       // if the objects are HLODs, replaces what is about meshes
  std::shared_ptr<const ViewCells> cells;  // of these objects, to walk through; null: refine
  CellSettings walk;
};

// Explains Occlusion::automatic: what was on and why. The choice's backend is one of the calibration's.
struct Explanation {
  EffectReport report;
  Calibration calibration;
};

struct RefinedSide {
  Refinement refinement;                           // refine_ms includes the time of the choice
  std::shared_ptr<const Explanation> explanation;  // of Occlusion::automatic
  std::uint64_t number = 0;   // of the refinement, ascending; unchanged if nothing was refined for the job
  std::uint64_t follows = 0;  // number of the refinement that its `changes` change; 0: none
  std::optional<std::size_t> visible_triangles;       // that own a pixel, if asked for
  std::vector<std::vector<glm::u8vec4>> seen_colors;  // those of ColorBy::visibility, if asked for
  std::vector<std::vector<glm::u8vec4>> colors;       // per object and triangle; empty where colours tell nothing
  std::shared_ptr<const DepthPyramid> occluder;       // if asked for and drawn
  std::shared_ptr<const DepthDifference> difference;  // in place of triangles: what is shown of this side; else null
};

// Never changes once it is handed over.
struct RefinedFrame {
  RefineJob job;
  // One of these is filled: as asked, and with `compare` also what is beside it, or by the other strategy. With cells,
  // the first side is what is drawn for the cell of the eye, and the second, to compare, a refinement.
  std::vector<RefinedSide> sides;
  std::vector<HlodSide> hlod_sides;
  std::shared_ptr<const CellsFrame> cells;        // of the first side, if the job has cells
  std::optional<hlod::StoreStats> cache;          // after this frame, of HLODs whose meshes are loaded on demand
  std::optional<hlod::DeviceCosts> device_costs;  // of the device that draws HLODs, if known
  std::uint64_t hash = 0;                         // of the first side
  // Tells that one more frame is worthwhile: a limit has left work over, vertices morph, other nodes may be drawn, or a
  // cell or meshes are being loaded.
  bool goes_on = false;
  std::string error;  // one line; if not empty, there are no sides

  [[nodiscard]] std::size_t side_count() const { return sides.size() + hlod_sides.size(); }
};

// Makes a backend on the worker's thread. Throws Error when this machine lacks it.
using MakeVisibility = std::function<std::unique_ptr<Visibility>(Occlusion)>;

class RefineWorker {
 public:
  // `calibration` is for Occlusion::automatic and for strategies that use the device's costs. What it lacks is measured
  // when it is first needed.
  explicit RefineWorker(MakeVisibility make_visibility, std::optional<Calibration> calibration = {},
                        MakeDevice make_device = make_portable_device);
  RefineWorker(const RefineWorker&) = delete;
  RefineWorker& operator=(const RefineWorker&) = delete;
  ~RefineWorker();

  // Replaces a job that has not been begun, but keeps its `from_scratch`.
  void request(RefineJob job);
  // Returns the last finished frame; null before the first.
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
