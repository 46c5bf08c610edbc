// Holds all that a user can set, as plain data. setting_table.h tells how each is named, shown, limited and saved.
#pragma once

#include "occlod/refiner.h"
#include "occlod/traverser.h"

namespace occlod::viewer {

// With `picture`, the software backend is shown the depth of each picture. With `automatic`, AutoRefiner chooses the
// effects that pay off in each view, with the software backend.
enum class Occlusion { none, software, picture, gl_query, automatic };

enum class Shading { smooth, flat };

// Names what a triangle's colour tells.
enum class ColorBy {
  plain,       // nothing: one colour for everything
  vertices,    // the colours of the file
  texture,     // its materials, with their images; one colour without
  level,       // the depth in the forest of the split that made it
  error,       // the error to the input, in pixels
  slip,        // how far its texture, hard normals and colours may have slipped, in pixels
  visibility,  // whether it owns a pixel, and if not, why
  outcome,     // what ended refinement here
  age,         // how long ago its split was last found visible
};

// Names what meshes and scenes are built as when they are opened.
enum class LoadAs { hierarchy, hlod };

// Names the device that draws HLODs and answers queries about their nodes.
enum class HlodDevice { gl, software };

// Names how nodes change between levels.
enum class HlodBetween { nothing, geomorph, within };

// Names what the colour of a triangle of an HLOD tells.
enum class HlodColorBy {
  plain,     // nothing
  vertices,  // the colours of the file
  texture,   // its textures and the colours of its materials
  level,     // of its node
  error,     // of its node, in pixels
  bias,      // by which factor the error of its node counted
  state,     // how its node came to be drawn
  patch,     // which patch it belongs to
};

// Names the nodes whose boxes are drawn.
enum class NodeBoxes {
  none,
  drawn,  // in the colours of their triangles
  asked,  // by the result of their query; others that are drawn, too (Guthe and others 2006, fig. 1)
};

struct HlodSettings {
  hlod::TraverseOptions traverse;                       // without what `between` and the device determine
  hlod::Strategy other_strategy = hlod::Strategy::vfc;  // in the right half of the split screen
  std::size_t most_triangles = 0;  // in a frame: the tolerance is raised until they do; 0: any number
  HlodBetween between = HlodBetween::nothing;
  HlodDevice device = HlodDevice::gl;
  bool settle = true;  // a static view is drawn until its front no longer changes
  HlodColorBy color_by = HlodColorBy::texture;
  NodeBoxes boxes = NodeBoxes::none;
};

// Names what the colour of a triangle of a view cell tells.
enum class CellColorBy {
  plain,     // nothing
  vertices,  // the colours of the file
  level,     // see ColorBy
  error,     // see ColorBy
  kept,      // whether it is drawn for the cell, and if not, why
};

// Names the view cells whose boxes are drawn, and what their colour tells.
enum class CellBoxes { none, cell, triangles, error, bytes, late };

struct CellSettings {
  bool walk = true;  // if cells are open
  bool prefetch = true;
  double memory_mb = 256.0;
  double disk_mb_s = 0.0;  // of a simulated disk; 0: reading takes no time
  double latency_ms = 5.0;
  CellColorBy color_by = CellColorBy::plain;
  bool left_out = false;
  CellBoxes boxes = CellBoxes::none;
};

// Names what the right half of the split screen shows of meshes.
enum class Beside {
  other,       // the same budget without occlusion
  full,        // the full meshes
  difference,  // how far the depth of what is refined is from theirs, in pixels
};

// Names the axis of world space along which the clipping plane stands.
enum class ClipAxis { none, x, y, z };

struct ClipSettings {
  ClipAxis axis = ClipAxis::none;
  double at = 0.5;    // share of the scene's extent along the axis
  bool flip = false;  // keep what lies beyond the plane, else what lies before it
};

// Names what the graph shows of the last pictures.
enum class Plot { times, triangles, visible, error };

enum class Theme { dark, light };

// Names how mouse and keys move the camera.
enum class Steering { orbit, fly, walk };

struct LookSettings {
  Shading shading = Shading::smooth;
  double crease_deg = 40.0;  // smooth shading stops at sharper edges
  ColorBy color_by = ColorBy::texture;
  bool wire = false;
  bool bounds = true;      // of the picked split: its sphere or box or cylinder
  bool cone = true;        // of the picked split: its normals
  bool antialias = true;   // four samples per pixel
  bool back_faces = true;  // draw them, darker
};

struct InsetSettings {
  bool birdseye = false;
  bool occluder = false;
  int pyramid_level = 0;  // of the occluder's depth
};

struct WindowSettings {
  bool sidebar = true;
  bool graph = true;
  bool help = false;
  bool legend = true;
  double scale = 0.0;  // of text and panels; 0: the display's
  Theme theme = Theme::dark;
  Plot plot = Plot::times;
};

struct Settings {
  LoadAs load_as = LoadAs::hierarchy;
  RefineOptions refine;
  HlodSettings hlod;
  CellSettings cells;
  bool frame_to_frame = true;  // continue from the last picture's mesh; else refine each from scratch
  Occlusion occlusion = Occlusion::software;
  bool freeze = false;   // refine for the camera of the time when it was set
  bool compare = false;  // show something beside it
  Beside beside = Beside::other;
  bool count_visible = true;   // triangles that own a pixel, by the item buffer
  double playback_rate = 1.0;  // of camera paths, frames per picture
  LookSettings look;
  ClipSettings clip;
  bool measure = false;  // clicks measure distances, and pick nothing
  InsetSettings insets;
  Steering steering = Steering::orbit;
  double speed = 0.5;  // fly and walk, scene radii per second
  WindowSettings window;
};

}  // namespace occlod::viewer
