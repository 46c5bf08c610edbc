// Holds what a frame of an HLOD has drawn, to draw it again from any eye and in any colours.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <vector>

#include "objects.h"
#include "occlod/picture.h"
#include "occlod/traverser.h"
#include "settings.h"

namespace occlod::viewer {

// Holds the triangles that a frame has drawn of one object, draw by draw.
struct FrontObject {
  std::vector<glm::vec3> positions;            // object space
  std::vector<glm::vec3> normals;              // per vertex, or none
  std::vector<glm::u8vec4> colors;             // sRGB, per vertex, or none
  std::vector<glm::vec2> texture_coordinates;  // per vertex, or none
  std::vector<MaterialId> materials;           // per vertex, or none: all have the first
  std::vector<glm::vec2> image_coordinates;    // per vertex, in its node's own image from the top left; negative where
                                               // it shows no such image; or none
  std::vector<Triangle> triangles;             // ids into positions
  std::vector<std::uint32_t> patches;          // per triangle, number of its patch in HlodView::patches; no_id in cuts
};

// Never changes once it is handed over.
struct HlodFront {
  std::uint64_t number = 0;                 // ascending over all fronts
  hlod::Frame frame;                        // without the indices of cuts
  std::vector<FrontObject> objects;         // of the job
  std::vector<std::size_t> first_triangle;  // per draw, into its object's triangles
};

// Holds one half of the picture, or all of it.
struct HlodSide {
  hlod::Strategy strategy = hlod::Strategy::coh;     // that was asked for
  std::shared_ptr<const HlodFront> front;            // not null
  double tolerance_px = 0.0;                         // with which it was drawn: raised for HlodSettings::most_triangles
  std::vector<std::vector<glm::u8vec4>> colors;      // per object and triangle; empty where colours tell nothing
  std::vector<std::shared_ptr<const Image>> images;  // per draw, its node's own or null; empty where none are shown
};

// Throws Error when a mapped file is damaged. O(triangles).
[[nodiscard]] std::shared_ptr<const HlodFront> make_front(const hlod::Frame& frame, const Objects& objects,
                                                          std::uint64_t number);

// Returns the draw that a triangle of an object comes from, as index into Frame::draws. O(draws).
[[nodiscard]] std::size_t draw_of(const HlodFront& front, std::size_t object, std::size_t triangle);

// Returns the screen-space error of the node as it was drawn, in pixels of the view.
[[nodiscard]] double error_px(const hlod::DrawnNode& draw, const PlacedObject& object, const View& view);

// Returns colours per object and triangle; none for an object where they tell nothing. The front was drawn for the
// view.
[[nodiscard]] std::vector<std::vector<glm::u8vec4>> colors_of(const HlodFront& front, const Objects& objects,
                                                              const View& view, const HlodSettings& settings);

}  // namespace occlod::viewer
