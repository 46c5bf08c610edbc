#include <gtest/gtest.h>

#include "occlod/core/error.h"
#include "occlod/occlusion/software_occlusion.h"
#include "viewer/golden.h"
#include "viewer/window_support.h"

namespace occlod::viewer::test {
namespace {

class Window : public WindowTest {};

TEST_F(Window, EveryWayOfLookingDrawsWithoutAComplaint) {
  start();
  for (const char* shading : {"smooth", "flat"})
    for (const char* by : {"plain", "vertices", "level", "error", "visibility", "outcome"})
      for (const bool wire : {false, true}) {
        set("shading", shading);
        set("color_by", by);
        set("wire", wire);
      }
  for (const char* name : {"antialias", "back_faces", "birdseye", "occluder", "compare", "freeze", "help"}) {
    const nlohmann::json flip = {{"do", "flip"}, {"setting", name}};
    act(flip);
    act(flip);
  }
  set("occluder", true);
  for (int level = 0; level < 12; ++level) set("pyramid_level", level);
  act({{"do", "pick"}, {"x", 0.5}, {"y", 0.9}});
  for (const char* proxy : {"sphere", "box", "cylinder"}) set("proxy", proxy);
  for (const double scale : {1.0, 2.0, 0.0}) set("scale", scale);
  act({{"do", "window_size"}, {"width", 640}, {"height", 480}});
  EXPECT_EQ(session().state().errors, 0) << session().state().notices.back().text;
}

// Their contexts are on the worker's thread; the answers are those of the library's own tests.
TEST_F(Window, OpenGlBackendsRefine) {
  start();
  set("budget", 2000);
  set("occlusion", "none");
  const double without = session().figures().at("visible_triangles");
  for (const char* backend : {"software", "gl-query", "gl-mark", "gl-compute"}) {
    set("occlusion", backend);
    EXPECT_EQ(session().state().errors, 0) << session().state().notices.back().text;
    EXPECT_GT(session().figures().at("queries_hidden"), 0.0) << backend;
    EXPECT_GT(session().figures().at("visible_triangles"), without) << backend;
  }
}

// The debug context is heard: the test above would fail.
TEST_F(Window, ComplaintsOfTheDriverAreErrors) {
  start();
  application_->window().functions().Enable(0xDEAD);
  draw(1);
  EXPECT_GE(session().state().errors, 1);
}

TEST_F(Window, ReplayedPathGivesTheMeshesOfTheLibrary) {
  start();
  set("budget", 2000);
  session().perform(nlohmann::json{{"do", "play"}, {"name", "by"}});
  draw(2);
  while (!session().state().playback.path.empty()) draw(1);
  std::map<int, std::uint64_t> hashes;
  for (const PictureRecord& record : session().timeline().records())
    if (record.path_frame >= 0) hashes[record.path_frame] = record.hash;
  const PlacedObject& object = session().state().objects->at(0);
  const RefineObject objects[] = {{object.mesh->hierarchy.get(), object.object_to_world, object.two_sided}};
  Refiner refiner(objects);
  const auto software = make_software_occlusion();
  RefineOptions options;
  options.budget = 2000;
  ASSERT_EQ(hashes.size(), 5U);
  for (const auto& [frame, hash] : hashes)
    EXPECT_EQ(hash,
              refiner.refine(View(camera_at(session().state().paths.at("by"), frame)), options, *software).hash());
}

TEST_F(Window, SequenceHasAPictureOfEachFrameAtThePathsSize) {
  start();
  const auto pictures = folder_.path("pictures");
  session().perform(nlohmann::json{{"do", "picture_sequence"}, {"name", "by"}, {"folder", pictures.string()}});
  draw(2);
  while (!session().state().playback.path.empty()) draw(1);
  std::vector<Image> images;
  for (const auto& entry : std::filesystem::directory_iterator(pictures)) images.push_back(read_png(entry.path()));
  ASSERT_EQ(images.size(), 5U);
  for (const Image& image : images) {
    EXPECT_EQ(image.width, 320);
    EXPECT_EQ(image.height, 240);
  }
  EXPECT_NE(difference(images[0], images[1]), "");  // the camera moves
}

// Panels stand beside the view, never over it: what is not sidebar or numbers shows the picture.
TEST_F(Window, WindowPictureHasPanelsAndView) {
  start();
  act({{"do", "screenshot"}, {"file", folder_.path("window.png").string()}, {"panels", true}});
  const Image window = read_png(folder_.path("window.png"));
  EXPECT_EQ(window.width, 1000);
  EXPECT_EQ(window.height, 700);
  const auto pixel = [&](int x, int y) { return window.pixels[static_cast<std::size_t>(y * window.width + x)]; };
  EXPECT_LT(pixel(5, 690).x, 60);   // the sidebar is dark
  EXPECT_GT(pixel(990, 5).x, 120);  // the sky is bright
}

// A script's picture shows what there was when its turn came, not what the next action made of it.
TEST_F(Window, ScriptTakesPicturesInTheirTurn) {
  const auto script =
      folder_.write("script.json", {{"actions",
                                     {{{"do", "open"}, {"file", folder_.write("planet.json", planet_scene()).string()}},
                                      {{"do", "screenshot"}, {"file", folder_.path("before.png").string()}},
                                      {{"do", "orbit"}, {"right", 90}, {"up", 0}},
                                      {{"do", "screenshot"}, {"file", folder_.path("after.png").string()}},
                                      {{"do", "close_all"}},
                                      {{"do", "screenshot"}, {"file", folder_.path("empty.png").string()}}}}});
  ApplicationOptions options;
  options.script = script;
  options.size = {800, 600};
  application_ = std::make_unique<Application>(options);
  application_->run();
  application_.reset();
  const Image before = read_png(folder_.path("before.png"));
  const Image after = read_png(folder_.path("after.png"));
  const Image empty = read_png(folder_.path("empty.png"));
  EXPECT_NE(difference(before, after), "");
  EXPECT_NE(difference(after, empty), "");
  EXPECT_NE(difference(before, empty), "");
}

TEST_F(Window, SecondViewerOpensAfterTheFirst) {
  start();
  application_.reset();
  start();
  EXPECT_EQ(session().state().errors, 0);
}

}  // namespace
}  // namespace occlod::viewer::test
