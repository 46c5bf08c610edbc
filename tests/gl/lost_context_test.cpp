// A context that is lost while a backend uses it: one error that says so, whatever was going on, and nothing else goes
// wrong.
#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

#include "gl/backends.h"
#include "gl/losing_context.h"
#include "occlod/base.h"

namespace occlod::gl {
namespace {

VisibilityQuery in_front() { return {0, Sphere{{0, 0, 0.5F}, 0.1F}}; }
VisibilityQuery behind() { return {0, Sphere{{0, 0, -0.5F}, 0.1F}}; }

class LostContext : public EachBackend {
 protected:
  // Everything that a backend does, with targets of two sizes.
  [[nodiscard]] std::vector<std::uint32_t> answers(const std::shared_ptr<Context>& context) const {
    const auto occlusion = GetParam().make(context);
    std::vector<std::uint32_t> result;
    for (const int width : {64, 80}) {
      Camera camera = view_.camera();
      camera.width = width;
      const View view(camera);
      const std::array<ObjectView, 1> objects{ObjectView(view, glm::dmat4(1.0))};
      occlusion->begin_view(view, objects);
      const Soup occluder = wall();
      const std::array<OccluderPart, 1> parts{occluder.part()};
      occlusion->draw_occluder(parts);
      for (int i = 0; i < 2; ++i) {
        occlusion->submit(behind());
        occlusion->submit(in_front());
      }
      for (int i = 0; i < 4; ++i) result.push_back(occlusion->collect());
    }
    return result;
  }
};

std::vector<TestedBackend> backends_on_egl() {
  std::vector<TestedBackend> all = tested_gl_backends();
  std::erase_if(all, [](const TestedBackend& tested) { return tested.platform != Platform::egl; });
  return all;
}
// The platform has no part in it.
INSTANTIATE_TEST_SUITE_P(Gl, LostContext, testing::ValuesIn(backends_on_egl()), backend_label);

const std::vector<std::uint32_t> right_answers{0, 1, 0, 1, 0, 1, 0, 1};

// Lost at each call in turn, from the first shader on: the one error is told, unless all answers had been given before;
// they are right then. What that error destroys does not throw, and the next context does not suffer.
TEST_P(LostContext, AtAnyCallIsOneError) {
  const auto whole = std::make_shared<LosingContext>(context_, std::numeric_limits<long>::max());
  ASSERT_EQ(answers(whole), right_answers);
  const long calls = LosingContext::calls;
  long losses = 0;
  for (long n = 0; n < calls; ++n) {
    SCOPED_TRACE("lost after call " + std::to_string(n));
    std::string why;
    const auto losing = std::make_shared<LosingContext>(GetParam().context(why), n);
    try {
      ASSERT_EQ(answers(losing), right_answers);
    } catch (const Error& error) {
      ASSERT_EQ(error.diagnosis().subject, "OpenGL");
      ASSERT_NE(std::string(error.what()).find("another program has made the GPU reset"), std::string::npos)
          << error.what();
      ASSERT_NE(error.diagnosis().remedy.find("software backend"), std::string::npos);
      ++losses;
    }
  }
  EXPECT_GT(losses, calls / 2);
  EXPECT_EQ(answers(context_), right_answers);
}

// Whoever goes on all the same is told again, though the driver tells the reset once only.
TEST_P(LostContext, StaysLost) {
  const auto whole = std::make_shared<LosingContext>(context_, std::numeric_limits<long>::max());
  const auto occlusion = GetParam().make(whole);
  start(*occlusion, wall());
  occlusion->submit(in_front());
  const auto lost = std::make_shared<LosingContext>(context_, 0);  // `whole` too: their tables share the calls
  EXPECT_THROW(static_cast<void>(occlusion->collect()), ContextLost);
  for (int i = 0; i < 2; ++i) EXPECT_THROW(start(*occlusion, wall()), ContextLost);
  EXPECT_THROW(static_cast<void>(GetParam().make(lost)), ContextLost);
}

TEST_P(LostContext, WhileWaitingIsNotASilentDriver) {
  const auto occlusion = GetParam().make(std::make_shared<HangingContext>(context_));
  const auto ask = [&] {
    start(*occlusion, wall());
    occlusion->submit(in_front());
    return occlusion->collect();
  };
  EXPECT_THROW(static_cast<void>(ask()), ContextLost);
}

// Mesa has such contexts for EGL; with NO_RESET_NOTIFICATION, the default, a driver never tells anything.
TEST(LostContexts, EglTellsResets) {
  std::string why;
  const std::shared_ptr<Context> context = context_or_null(Platform::egl, why);
  if (!context || context->version().find("Mesa") == std::string::npos) GTEST_SKIP() << "no context of Mesa: " << why;
  GLint strategy = 0;
  context->functions().GetIntegerv(GL_RESET_NOTIFICATION_STRATEGY, &strategy);
  EXPECT_EQ(strategy, GL_LOSE_CONTEXT_ON_RESET);
  ASSERT_NE(context->functions().GetGraphicsResetStatus, nullptr);
  EXPECT_EQ(context->functions().GetGraphicsResetStatus(), GLenum{GL_NO_ERROR});
}

// The table alone: no driver.
Functions table(PFNGLGETGRAPHICSRESETSTATUSPROC status, PFNGLGETERRORPROC error) {
  Functions gl;
  gl.GetGraphicsResetStatus = status;
  gl.GetError = error;
  return gl;
}

std::string message_of(const Functions& gl) {
  try {
    check(gl, "a step");
    return "";
  } catch (const ContextLost& error) {
    return error.what();
  }
}

TEST(LostContexts, TheReasonIsTold) {
  const PFNGLGETERRORPROC no_error = []() -> GLenum { return GL_NO_ERROR; };
  const PFNGLGETERRORPROC lost = []() -> GLenum { return GL_CONTEXT_LOST; };
  const auto guilty = []() -> GLenum { return GL_GUILTY_CONTEXT_RESET; };
  const auto innocent = []() -> GLenum { return GL_INNOCENT_CONTEXT_RESET; };
  const auto unknown = []() -> GLenum { return GL_UNKNOWN_CONTEXT_RESET; };
  const std::string remedy = "; run again, or use the software backend";
  EXPECT_EQ(message_of(table(guilty, no_error)),
            "OpenGL: a step: the context is lost: this program has made the GPU reset" + remedy);
  EXPECT_EQ(message_of(table(innocent, lost)),
            "OpenGL: a step: the context is lost: another program has made the GPU reset" + remedy);
  const std::string not_known =
      "OpenGL: a step: the context is lost: the GPU was reset, for a reason that the driver does not know" + remedy;
  EXPECT_EQ(message_of(table(unknown, no_error)), not_known);
  EXPECT_EQ(message_of(table(nullptr, lost)), not_known);
  EXPECT_EQ(message_of(table(nullptr, no_error)), "");
}

// Drivers by what they say of themselves; all hand out an address for any name.
int driver_version = 0;
const char* driver_extension = "";
std::vector<std::string> names_asked;

Functions load_from_driver(int version, const char* extension) {
  driver_version = version;
  driver_extension = extension;
  names_asked.clear();
  return load_functions(
      [](const char* name) -> Proc {
        names_asked.emplace_back(name);
        if (std::strcmp(name, "glGetIntegerv") == 0)
          return reinterpret_cast<Proc>(+[](GLenum what, GLint* value) {
            *value = what == GL_MAJOR_VERSION   ? driver_version / 10
                     : what == GL_MINOR_VERSION ? driver_version % 10
                                                : 1;
          });
        if (std::strcmp(name, "glGetStringi") == 0)
          return reinterpret_cast<Proc>(+[](GLenum, GLuint) { return driver_extension; });
        return [] {};
      },
      "test driver");
}

// OpenGL 4.5 and KHR_robustness have the function without a suffix (KHR_robustness, "New Procedures": without one in
// OpenGL), ARB_robustness with its own. Where none is offered, the address that a driver hands out is not to be called.
TEST(LostContexts, TheFunctionIsTakenFromWhereItIsOffered) {
  const auto asked = [](const char* name) { return std::count(names_asked.begin(), names_asked.end(), name); };
  for (const auto& [version, extension] : {std::pair(45, "GL_none"), std::pair(33, "GL_KHR_robustness")}) {
    EXPECT_NE(load_from_driver(version, extension).GetGraphicsResetStatus, nullptr);
    EXPECT_EQ(asked("glGetGraphicsResetStatus"), 1);
  }
  EXPECT_NE(load_from_driver(33, "GL_ARB_robustness").GetGraphicsResetStatus, nullptr);
  EXPECT_EQ(asked("glGetGraphicsResetStatus"), 0);
  EXPECT_EQ(asked("glGetGraphicsResetStatusARB"), 1);
  EXPECT_EQ(load_from_driver(44, "GL_ARB_robustness_isolation").GetGraphicsResetStatus, nullptr);
}

}  // namespace
}  // namespace occlod::gl
