#include <gtest/gtest.h>

#include <algorithm>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include "draw/overlays.h"
#include "draw/render_target.h"
#include "draw/scene_drawing.h"
#include "occlod/base.h"
#include "occlod/mesh_file.h"
#include "occlod/visibility.h"
#include "palette.h"
#include "viewer/golden.h"
#include "viewer/window_support.h"

namespace occlod::viewer::test {
namespace {

class Window : public WindowTest {
 protected:
  [[nodiscard]] Image screenshot() {
    act({{"do", "screenshot"}, {"file", folder_.path("picture.png").string()}});
    return read_png(folder_.path("picture.png"));
  }
};

// Each colouring is another picture, but for the colours of a mesh that has none.
TEST_F(Window, EveryWayOfLookingIsAPictureOfItsOwn) {
  start();
  act({{"do", "picture_size"}, {"width", 200}, {"height", 150}});
  act({{"do", "go_to"}, {"name", "far"}});
  set("budget", 1500);
  set("freeze", true);
  act({{"do", "orbit"}, {"right", 70}, {"up", -20}});
  std::vector<Image> pictures;
  for (const char* by : {"plain", "level", "error", "visibility", "outcome", "age"})
    for (const char* shading : {"smooth", "flat"})
      for (const bool wire : {false, true}) {
        set("shading", shading);
        set("color_by", by);
        set("wire", wire);
        const Image picture = screenshot();
        // The colours that tell something are those of triangles, flat whatever the shading.
        if (by != std::string("plain") && shading == std::string("flat")) continue;
        for (const Image& other : pictures) EXPECT_NE(difference(picture, other), "") << by << shading << wire;
        pictures.push_back(picture);
      }
  act({{"do", "close_all"}});
  const Image nothing = screenshot();
  for (const Image& picture : pictures) EXPECT_NE(difference(picture, nothing), "");
}

// Nobody sees a back face of a closed mesh: drawn or culled, darker or not, the picture is the same to the pixel. At a
// contour the back face behind it is as near as the front face, but for rounding.
TEST_F(Window, BackFacesDoNotWinAtContours) {
  nlohmann::json scene = planet_scene(8);
  scene["objects"].push_back(scene["objects"][0]);
  scene["objects"][1]["scale"] = -1;  // mirrored
  start(scene);
  set("antialias", false);
  act({{"do", "picture_size"}, {"width", 800}, {"height", 600}});
  act({{"do", "go_to"}, {"name", "far"}});
  set("budget", 10'000);
  for (std::size_t shown = 0; shown < 2; ++shown) {
    const std::uint64_t id = session().state().objects->at(shown).id;
    for (const PlacedObject& object : *session().state().objects)
      session().perform(nlohmann::json{{"do", "show"}, {"object", object.id}, {"shown", object.id == id}});
    for (int i = 0; i < 3; ++i) {
      act({{"do", "orbit"}, {"right", 20}, {"up", 3}});
      set("back_faces", false);
      const Image culled = screenshot();
      set("back_faces", true);
      EXPECT_TRUE(screenshot().pixels == culled.pixels) << shown << " " << i;
    }
  }
}

// The faces of a box meet at 90 degrees: smooth shading is flat there, unless creases of 90 degrees are smooth. A ball
// of 128 triangles bends by less than 40 degrees at each edge: it is smooth all over.
TEST_F(Window, SmoothShadingStopsAtCreases) {
  TriangleMesh box;
  box.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}};
  box.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                   {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  write_mesh(folder_.path("box.ply"), box);
  write_mesh(folder_.path("ball.ply"), generate("rough-planet", {{"level", 2}, {"amplitude", 0.0}}));
  start();
  for (const char* name : {"box", "ball"}) {
    act({{"do", "close_all"}});
    act({{"do", "open"}, {"file", folder_.path(name + std::string(".ply")).string()}});
    for (const bool mirrored : {false, true}) {
      if (mirrored) act({{"do", "orbit"}, {"right", 180}, {"up", 60}});  // other sides
      set("shading", "flat");
      const Image flat = screenshot();
      set("shading", "smooth");
      EXPECT_EQ(difference(screenshot(), flat) == "", name == std::string("box")) << name;
      const Image by_default = screenshot();
      set("crease_angle", 180);
      EXPECT_NE(difference(screenshot(), flat), "") << name;
      EXPECT_EQ(difference(screenshot(), by_default) == "", name == std::string("ball")) << name;
      set("crease_angle", 0);
      EXPECT_EQ(difference(screenshot(), flat), "") << name;
      set("crease_angle", 40);
    }
  }
}

// The right half of a square is clipped: there is the background, on the left the square is as it was, in every way of
// drawing it.
TEST_F(Window, TheClippingPlaneCutsOffOneSide) {
  TriangleMesh square;
  square.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  square.triangles = {{0, 1, 2}, {0, 2, 3}};
  write_mesh(folder_.path("square.ply"), square);
  start();
  act({{"do", "close_all"}});
  act({{"do", "picture_size"}, {"width", 80}, {"height", 60}});
  const Image nothing = screenshot();
  act({{"do", "open"}, {"file", folder_.path("square.ply").string()}});
  act({{"do", "camera"}, {"eye", {0, 0, 3}}, {"target", {0, 0, 0}}, {"orthographic_height", 3}});
  for (const bool wire : {false, true}) {
    set("wire", wire);
    const Image whole = screenshot();
    set("clip_axis", "x");
    const Image half = screenshot();
    set("clip_axis", "none");
    const auto left = static_cast<std::size_t>(80 * 20 + 30), right = left + 20;
    EXPECT_EQ(half.pixels[left], whole.pixels[left]);
    EXPECT_NE(half.pixels[left], nothing.pixels[left]);
    EXPECT_EQ(half.pixels[right], nothing.pixels[right]);
    EXPECT_NE(whole.pixels[right], nothing.pixels[right]);
  }
}

// Both ends and the line between them are drawn over the mesh, and the panels say how long it is.
TEST_F(Window, ADistanceIsDrawn) {
  start();
  act({{"do", "go_to"}, {"name", "far"}});
  const Image before = screenshot();
  act({{"do", "measure"}, {"x", 0.45}, {"y", 0.5}});
  act({{"do", "measure"}, {"x", 0.55}, {"y", 0.5}});
  const Image with_line = screenshot();
  std::size_t changed = 0;
  for (std::size_t i = 0; i < before.pixels.size(); ++i) changed += with_line.pixels[i] != before.pixels[i] ? 1U : 0U;
  EXPECT_GT(changed, 60U);  // a tenth of the width at least
}

// The left half is the same whatever is beside it, and each of these is a picture of its own. Where depths differ by
// little all of the planet has one colour, and round it there is none.
TEST_F(Window, TheFullMeshAndTheDifferenceAreDrawn) {
  start();
  act({{"do", "picture_size"}, {"width", 160}, {"height", 120}});
  act({{"do", "go_to"}, {"name", "far"}});
  set("frame_to_frame", false);
  set("budget", 1500);
  set("compare", true);
  std::vector<Image> pictures;
  for (const char* beside : {"other", "full", "difference"}) {
    set("beside", beside);
    pictures.push_back(screenshot());
    ASSERT_EQ(pictures.back().width, 320);
    std::size_t changed[2] = {0, 0};
    for (int y = 0; y < 120; ++y)
      for (int x = 0; x < 320; ++x) {
        const auto i = static_cast<std::size_t>(y * 320 + x);
        changed[x / 160] +=
            pictures.back().pixels[i] != pictures[pictures.size() > 1 ? pictures.size() - 2 : 0].pixels[i];
      }
    EXPECT_EQ(changed[0], 0U) << beside;
    EXPECT_TRUE(pictures.size() == 1 || changed[1] > 1000) << beside;
  }
  const auto at = [&](int x, int y) { return glm::u8vec3(pictures[2].pixels[static_cast<std::size_t>(y * 320 + x)]); };
  EXPECT_EQ(at(161, 1), glm::u8vec3(no_surface_color));
  EXPECT_EQ(at(318, 118), glm::u8vec3(no_surface_color));
  EXPECT_NE(at(240, 60), glm::u8vec3(no_surface_color));
}

// The light theme and each plot are pictures of their own.
TEST_F(Window, ThemesAndPlots) {
  start();
  const auto window = [&] {
    act({{"do", "screenshot"}, {"file", folder_.path("window.png").string()}, {"panels", true}});
    return read_png(folder_.path("window.png"));
  };
  const auto mean_of_sidebar = [](const Image& image) {
    double sum = 0.0;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < 300; ++x) sum += image.pixels[static_cast<std::size_t>(y * image.width + x)].x;
    return sum / (300.0 * image.height);
  };
  EXPECT_LT(mean_of_sidebar(window()), 80.0);
  set("theme", "light");
  EXPECT_GT(mean_of_sidebar(window()), 180.0);
  set("theme", "dark");
  std::vector<Image> pictures;
  for (const char* plot : {"times", "triangles", "visible", "error"}) {
    set("plot", plot);
    const Image picture = window();
    for (const Image& other : pictures) {
      std::size_t changed = 0;  // in the graph
      for (int y = picture.height - 110; y < picture.height - 10; ++y)
        for (int x = picture.width - 200; x < picture.width - 12; ++x) {
          const auto i = static_cast<std::size_t>(y * picture.width + x);
          changed += picture.pixels[i] != other.pixels[i] ? 1U : 0U;
        }
      EXPECT_GT(changed, 50U) << plot;
    }
    pictures.push_back(picture);
  }
}

TEST_F(Window, EveryWayOfLookingDrawsWithoutAComplaint) {
  start();
  for (const char* shading : {"smooth", "flat"})
    for (const char* by : {"plain", "vertices", "level", "error", "visibility", "outcome", "age"})
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

// Head light is the same on all of a plane that parallel rays meet, key light and sky are those of its direction.
TEST_F(Window, ParallelRaysLightAPlaneEvenly) {
  TriangleMesh mesh;
  mesh.positions = {{-9, -9, 2}, {9, -9, -2}, {9, 9, -2}, {-9, 9, 2}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  write_mesh(folder_.path("plane.ply"), mesh);
  start();
  act({{"do", "close_all"}});
  act({{"do", "open"}, {"file", folder_.path("plane.ply").string()}});
  for (const char* shading : {"smooth", "flat"}) {
    set("shading", shading);
    for (const bool parallel : {false, true}) {
      const char* lens = parallel ? "orthographic_height" : "fov_y_deg";
      act({{"do", "camera"}, {"eye", {0, 0, 3}}, {"target", {0, 0, 0}}, {lens, parallel ? 6 : 90}, {"near", 0.1}});
      const Image picture = screenshot();
      const auto [least, most] = std::minmax_element(picture.pixels.begin(), picture.pixels.end(),
                                                     [](const auto& a, const auto& b) { return a.x < b.x; });
      EXPECT_EQ(most->x - least->x <= 1, parallel) << shading << " " << int{least->x} << " " << int{most->x};
    }
  }
}

// The border of what is refined for, from the eye to behind the scene: edges end at corners of the picture, or at the
// eye of perspective, and there are those of a pyramid or a box. From above all of a box is seen.
TEST_F(Window, FrozenFrustumEndsAtTheCornersOfItsPicture) {
  start();
  act({{"do", "frame_all"}});
  for (const bool parallel : {false, true}) {
    act({{"do", "orthographic"}, {"on", parallel}});
    set("freeze", true);
    const Camera& refined = session().refine_camera();
    const std::vector<Line> lines = main_overlay(session());
    EXPECT_EQ(lines.size(), parallel ? 12U : 8U);
    for (const Line& line : lines)
      for (const glm::dvec3& end : {line.a, line.b}) {
        if (!parallel && end == refined.eye) continue;
        const glm::dvec4 clip = View(refined).world_to_clip() * glm::dvec4(end, 1.0);
        EXPECT_NEAR(std::abs(clip.x / clip.w), 1.0, 1e-9);
        EXPECT_NEAR(std::abs(clip.y / clip.w), 1.0, 1e-9);
        const glm::dvec4 above = View(birdseye_camera(session(), 400, 300)).world_to_clip() * glm::dvec4(end, 1.0);
        EXPECT_TRUE(!parallel || glm::all(glm::lessThan(glm::abs(glm::dvec2(above)), glm::dvec2(above.w))));
      }
    set("freeze", false);
  }
}

// Their contexts are on the worker's thread; the answers are those of the library's own tests.
TEST_F(Window, OpenGlBackendsRefine) {
  start();
  set("budget", 2000);
  set("occlusion", "none");
  const double without = session().figures().at("visible_triangles");
  for (const char* backend : {"software", "picture", "gl-query", "auto"}) {
    set("occlusion", backend);
    EXPECT_EQ(session().state().errors, 0) << session().state().notices.back().text;
    if (backend == std::string("auto")) continue;  // chooses by what it has timed
    EXPECT_GT(session().figures().at("queries_hidden"), 0.0) << backend;
    EXPECT_GT(session().figures().at("visible_triangles"), without) << backend;
  }
  act({{"do", "orthographic"}});
  for (const char* backend : {"software", "gl-query"}) {
    set("occlusion", backend);
    EXPECT_EQ(session().state().errors, 0) << session().state().notices.back().text;
    EXPECT_GT(session().figures().at("queries_hidden"), 0.0) << backend;
  }
}

// The debug context is heard: the test above would fail.
TEST_F(Window, ComplaintsOfTheDriverAreErrors) {
  start();
  application_->window().functions().Enable(0xDEAD);
  draw(1);
  EXPECT_GE(session().state().errors, 1);
}

// Frame to frame, whose buffers are changed here and there; nothing is uploaded while nothing changes.
TEST_F(Window, ReplayedPathGivesTheFramesOfTheLibrary) {
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
              refiner.update(View(camera_at(session().state().paths.at("by"), frame)), options, *software).hash());
}

// What is uploaded for a frame that follows is in proportion to what has changed, and draws what everything would.
TEST_F(Window, ChangedTrianglesAreUploadedAlone) {
  start();
  set("budget", 20'000);
  act({{"do", "go_to"}, {"name", "far"}});
  SceneDrawing kept(application_->window().functions());
  RenderTarget kept_target(application_->window().functions()), fresh_target(application_->window().functions());
  const LookSettings& look = session().state().settings.look;
  const auto picture = [&](SceneDrawing& drawing, RenderTarget& target) {
    drawing.draw(target, session().state().camera, 0, look, {});
    return target.read();
  };
  const std::size_t everything = kept.upload(session().frame());
  EXPECT_EQ(everything, session().frame()->sides[0].refinement.objects[0].triangles.size() * sizeof(Triangle));
  for (const int geomorph_frames : {0, 5}) {
    set("geomorph_frames", geomorph_frames);
    for (int i = 0; i < 6; ++i) {
      session().perform(nlohmann::json{{"do", "orbit"}, {"right", 1}, {"up", 0}});
      do draw(1);
      while (!session().is_current());
      ASSERT_EQ(session().frame()->sides[0].refinement.objects[0].geomorphs.empty(), geomorph_frames == 0);
      const std::size_t bytes = kept.upload(session().frame());
      EXPECT_GT(bytes, 0U);
      EXPECT_LT(bytes, geomorph_frames == 0 ? everything / 2 : 100 * everything);
      SceneDrawing fresh(application_->window().functions());
      static_cast<void>(fresh.upload(session().frame()));
      EXPECT_TRUE(picture(kept, kept_target).pixels == picture(fresh, fresh_target).pixels) << i;
    }
    while (!session().settled()) draw(1);
  }
}

TEST_F(Window, StillCameraUploadsNothing) {
  start();
  draw(3);
  const std::size_t before = session().timeline().records().size();
  draw(5);
  const auto& records = session().timeline().records();
  for (std::size_t i = before; i < records.size(); ++i) EXPECT_EQ(records[i].cost.uploaded_bytes, 0U);
  EXPECT_GE(records.size(), before + 5);
}

// On its way a vertex is not at its own place; when all have arrived the picture is that of the mesh alone, to the
// pixel.
TEST_F(Window, GeomorphsAreDrawnAndArrive) {
  start();
  act({{"do", "go_to"}, {"name", "far"}});
  set("budget", 1000);
  set("geomorph_frames", 8);
  session().perform(nlohmann::json{{"do", "set"}, {"setting", "budget"}, {"value", 1500}});
  do draw(1);
  while (!session().is_current());
  ASSERT_FALSE(session().frame()->sides[0].refinement.objects[0].geomorphs.empty());
  const gl::Functions& gl = application_->window().functions();
  SceneDrawing drawing(gl);
  RenderTarget target(gl);
  const auto picture = [&](SceneDrawing& with, std::shared_ptr<const RefinedFrame> frame) {
    static_cast<void>(with.upload(std::move(frame)));
    with.draw(target, session().state().camera, 0, session().state().settings.look, {});
    return target.read().pixels;
  };
  const auto without_geomorphs = [&] {
    auto frame = std::make_shared<RefinedFrame>(*session().frame());
    frame->sides[0].refinement.objects[0].geomorphs.clear();
    SceneDrawing fresh(gl);
    return picture(fresh, frame);
  };
  EXPECT_FALSE(picture(drawing, session().frame()) == without_geomorphs());
  for (; !session().settled(); draw(1)) static_cast<void>(picture(drawing, session().frame()));
  EXPECT_TRUE(session().frame()->sides[0].refinement.objects[0].geomorphs.empty());
  EXPECT_TRUE(picture(drawing, session().frame()) == without_geomorphs());
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

// The colours are explained in the picture itself, in its lower left corner, unless the legend is off.
TEST_F(Window, PicturesWithoutPanelsHaveTheLegend) {
  start();
  set("color_by", "level");
  const Image without = screenshot();
  set("legend", true);
  const Image with = screenshot();
  ASSERT_EQ(with.pixels.size(), without.pixels.size());
  std::size_t changed = 0;
  for (int y = 0; y < with.height; ++y)
    for (int x = 0; x < with.width; ++x) {
      const auto i = static_cast<std::size_t>(y * with.width + x);
      if (with.pixels[i] == without.pixels[i]) continue;
      ++changed;
      EXPECT_TRUE(x < with.width / 2 && y > with.height / 2) << x << " " << y;
    }
  EXPECT_GT(changed, 5000U);
  set("color_by", "plain");
  const Image plain = screenshot();
  set("legend", false);
  EXPECT_EQ(difference(plain, screenshot()), "") << "they tell nothing";
  set("legend", true);
  set("color_by", "level");
  act({{"do", "picture_size"}, {"width", 100}, {"height", 80}});
  static_cast<void>(screenshot());
  EXPECT_NE(session().state().notices.back().text.find("no room"), std::string::npos);
}

// Nothing in the sidebar is elsewhere after a click into the view, or after one that selects nothing.
TEST_F(Window, APickDoesNotShiftTheSidebar) {
  start();
  const auto sidebar = [&] {
    act({{"do", "screenshot"}, {"file", folder_.path("window.png").string()}, {"panels", true}});
    const Image window = read_png(folder_.path("window.png"));
    std::vector<glm::u8vec4> pixels;
    for (int y = 170; y < window.height; ++y)  // below the objects, of which one is marked
      for (int x = 0; x < 320; ++x) pixels.push_back(window.pixels[static_cast<std::size_t>(y * window.width + x)]);
    return pixels;
  };
  const auto before = sidebar();
  act({{"do", "pick"}, {"x", 0.5}, {"y", 0.9}});
  ASSERT_TRUE(session().state().pick);
  EXPECT_TRUE(sidebar() == before);
  act({{"do", "unpick"}});
  EXPECT_TRUE(sidebar() == before);
}

TEST_F(Window, ARecordingShows) {
  start();
  const auto top = [&] {
    act({{"do", "screenshot"}, {"file", folder_.path("window.png").string()}, {"panels", true}});
    const Image window = read_png(folder_.path("window.png"));
    // Red text between the sidebar and the right border.
    return std::count_if(window.pixels.begin(), window.pixels.begin() + std::ptrdiff_t{60} * window.width,
                         [](const glm::u8vec4& p) { return p.x > 180 && p.y < 120 && p.z < 120; });
  };
  EXPECT_EQ(top(), 0);
  act({{"do", "record"}, {"name", "mine"}});
  EXPECT_GT(top(), 50);
  act({{"do", "stop"}});
  EXPECT_EQ(top(), 0);
}

// What does not change while the viewer is at rest: without the strip at the bottom, where times and memory stand, but
// for the first column of its table, the names.
std::vector<glm::u8vec4> lasting_pixels(const Image& window, const Area& strip) {
  constexpr float names_width = 70.0F;
  std::vector<glm::u8vec4> pixels;
  for (int y = 0; y < window.height; ++y)
    for (int x = 0; x < window.width; ++x)
      if (!strip.holds({static_cast<float>(x) - names_width, static_cast<float>(y)}))
        pixels.push_back(window.pixels[static_cast<std::size_t>(y * window.width + x)]);
  return pixels;
}

// Dear ImGui needs some pictures for its layout: of a new scene, of another window size, of insets that have appeared.
TEST_F(Window, FirstPictureWithPanelsIsLaidOut) {
  start({{"objects", {{{"generator", "rough-planet"}, {"options", {{"level", 3}}}}}},
         {"cameras", {{"default", {{"eye", {0, 0, 3}}, {"target", {0, 0, 0}}}}}}});
  const auto expect_laid_out = [&](int width, int height) {
    std::vector<std::vector<glm::u8vec4>> pictures;
    for (int i = 0; i < 2; ++i) {
      act({{"do", "screenshot"}, {"file", folder_.path("window.png").string()}, {"panels", true}});
      const Image window = read_png(folder_.path("window.png"));
      ASSERT_EQ(std::pair(window.width, window.height), std::pair(width, height));
      const ImVec2 size(static_cast<float>(width), static_cast<float>(height));
      pictures.push_back(lasting_pixels(window, lay_out(session(), size, 1.0F).graph));
      draw(5);
    }
    EXPECT_TRUE(pictures[0] == pictures[1]) << width << "x" << height;
  };
  // Only performed: the screenshot is asked for before anything is drawn.
  const auto perform = [&](const nlohmann::json& action) { session().perform(action); };
  for (const char* inset : {"birdseye", "occluder"}) perform({{"do", "set"}, {"setting", inset}, {"value", true}});
  perform({{"do", "set"}, {"setting", "legend"}, {"value", true}});
  perform({{"do", "set"}, {"setting", "color_by"}, {"value", "visibility"}});
  expect_laid_out(1000, 700);
  for (const auto& [width, height] : {std::pair(700, 500), std::pair(1200, 800)}) {
    act({{"do", "close_all"}});
    perform({{"do", "window_size"}, {"width", width}, {"height", height}});
    perform({{"do", "open"}, {"file", folder_.write("other.json", planet_scene(4)).string()}});
    expect_laid_out(width, height);
    perform({{"do", "window_size"}, {"width", width + 100}, {"height", height + 60}});
    expect_laid_out(width + 100, height + 60);
  }
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
