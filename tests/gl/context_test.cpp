#include "gl/context.h"

#include <cstdlib>
#include <cstring>

#include "gl/support.h"
#include "occlod/base.h"

namespace occlod::gl {
namespace {

class EachPlatform : public testing::TestWithParam<Platform> {};
INSTANTIATE_TEST_SUITE_P(Contexts, EachPlatform, testing::Values(Platform::egl, Platform::osmesa),
                         [](const auto& param) { return platform_label(param.param); });

TEST_P(EachPlatform, OffersOpenGl33) {
  std::string context_missing;
  const std::shared_ptr<Context> context = context_or_null(GetParam(), context_missing);
  if (!context) GTEST_SKIP() << "no context: " << context_missing;
  EXPECT_FALSE(context->renderer().empty());
  GLint major = 0;
  GLint minor = 0;
  context->functions().GetIntegerv(GL_MAJOR_VERSION, &major);
  context->functions().GetIntegerv(GL_MINOR_VERSION, &minor);
  EXPECT_GE(10 * major + minor, 33);
  // GL_VERSION of a core profile starts with "major.minor".
  EXPECT_EQ(context->version().rfind(std::to_string(major) + "." + std::to_string(minor), 0), 0U);
  const std::string name(context->platform_name());
  EXPECT_TRUE(GetParam() == Platform::osmesa ? name == "osmesa" : name == "egl-surfaceless" || name == "egl-device");
}

TEST_P(EachPlatform, CheckThrowsTheErrorOnceAndNamesTheStep) {
  std::string context_missing;
  const std::shared_ptr<Context> context = context_or_null(GetParam(), context_missing);
  if (!context) GTEST_SKIP() << "no context: " << context_missing;
  const Functions& gl = context->functions();
  EXPECT_NO_THROW(check(gl, "nothing"));
  gl.Enable(GL_TRIANGLES);  // not a capability: INVALID_ENUM by the specification of glEnable
  try {
    check(gl, "the wrong step");
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.diagnosis().place, "the wrong step");
    EXPECT_NE(error.diagnosis().problem.find("GL_INVALID_ENUM"), std::string::npos);
  }
  EXPECT_NO_THROW(check(gl, "nothing"));
}

// Each context has its own clear depth; whoever is current must answer with its own, also between platforms, which
// share Mesa's slot for the current context.
void expect_separate(Context& first, Context& second) {
  first.make_current();
  first.functions().ClearDepth(0.25);
  second.make_current();
  second.functions().ClearDepth(0.75);
  for (int round = 0; round < 3; ++round) {
    GLint depth = 0;  // as an integer, 1.0 is the largest
    first.make_current();
    first.functions().GetIntegerv(GL_DEPTH_CLEAR_VALUE, &depth);
    EXPECT_NEAR(depth / 2147483647.0, 0.25, 1e-6);
    second.make_current();
    second.functions().GetIntegerv(GL_DEPTH_CLEAR_VALUE, &depth);
    EXPECT_NEAR(depth / 2147483647.0, 0.75, 1e-6);
  }
}

TEST_P(EachPlatform, TwoOfAKindAreSeparate) {
  std::string first_missing;
  const std::shared_ptr<Context> first = context_or_null(GetParam(), first_missing);
  if (!first) GTEST_SKIP() << "no context: " << first_missing;
  std::string second_missing;
  const std::shared_ptr<Context> second = context_or_null(GetParam(), second_missing);
  if (!second) GTEST_SKIP() << "no context: " << second_missing;
  expect_separate(*first, *second);
}

TEST(Contexts, EglAndOsMesaAreSeparate) {
  std::string egl_missing;
  const std::shared_ptr<Context> egl = context_or_null(Platform::egl, egl_missing);
  if (!egl) GTEST_SKIP() << "no context: " << egl_missing;
  std::string osmesa_missing;
  const std::shared_ptr<Context> osmesa = context_or_null(Platform::osmesa, osmesa_missing);
  if (!osmesa) GTEST_SKIP() << "no context: " << osmesa_missing;
  expect_separate(*egl, *osmesa);
}

TEST(Contexts, DestroyingOneLeavesTheOtherUsable) {
  std::string kept_missing;
  const std::shared_ptr<Context> kept = context_or_null(Platform::egl, kept_missing);
  if (!kept) GTEST_SKIP() << "no context: " << kept_missing;
  for (int i = 0; i < 3; ++i) {
    std::string why;
    for (const Platform platform : {Platform::egl, Platform::osmesa}) static_cast<void>(context_or_null(platform, why));
    kept->make_current();
    EXPECT_FALSE(kept->renderer().empty());
    EXPECT_NO_THROW(check(kept->functions(), "after the other has gone"));
  }
}

TEST(Contexts, EglDevicesAreAWayOfTheirOwn) {
  try {
    const auto context = create_egl_context(EglDisplayKind::device);
    EXPECT_EQ(context->platform_name(), "egl-device");
    EXPECT_FALSE(context->renderer().empty());
  } catch (const Error& error) {
    GTEST_SKIP() << "no context: " << error.what();
  }
}

// Mesa names its device that draws on the processor, so that one never counts as a GPU.
TEST(Contexts, AGpuDoesNotDrawOnTheProcessor) {
  try {
    const auto context = create_egl_context(EglDisplayKind::gpu);
    EXPECT_EQ(context->platform_name(), "egl-device");
    EXPECT_FALSE(draws_on_cpu(context->renderer())) << context->renderer();
  } catch (const Error& error) {
    EXPECT_EQ(error.diagnosis().subject, "EGL");
    GTEST_SKIP() << "no GPU: " << error.what();
  }
}

// Whichever library answers for the platform without surfaces.
TEST(Contexts, EglPrefersAGpu) {
  std::string egl_missing;
  const std::shared_ptr<Context> egl = context_or_null(Platform::egl, egl_missing);
  if (!egl) GTEST_SKIP() << "no context: " << egl_missing;
  bool has_gpu = false;
  try {
    has_gpu = !draws_on_cpu(create_egl_context(EglDisplayKind::gpu)->renderer());
  } catch (const Error&) {
  }
  EXPECT_FALSE(has_gpu && draws_on_cpu(egl->renderer())) << egl->renderer();
  egl->make_current();
  EXPECT_NO_THROW(check(egl->functions(), "after looking for a GPU"));
}

TEST(Contexts, AnyContextPrefersEgl) {
  std::string egl_missing;
  const std::shared_ptr<Context> egl = context_or_null(Platform::egl, egl_missing);
  if (!egl) GTEST_SKIP() << "no context: " << egl_missing;
  EXPECT_EQ(create_any_context()->platform_name(), egl->platform_name());
}

// A driver that knows every function but one must be refused, by the name of that one.
TEST(Contexts, AMissingFunctionIsNamed) {
  const GetProc all_but_one = [](const char* name) -> Proc {
    if (std::strcmp(name, "glEndQuery") == 0) return nullptr;
    return [] {};
  };
  try {
    static_cast<void>(load_functions(all_but_one, "test driver"));
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("glEndQuery"), std::string::npos);
    EXPECT_EQ(error.diagnosis().subject, "test driver");
    EXPECT_FALSE(error.diagnosis().remedy.empty());
  }
}

// No machine has these: the message names the library or function, and tells what to do about the former.
TEST(SharedLibraries, WhatIsMissingIsNamed) {
  try {
    const SharedLibrary library({"libnobody-has-this.so.1", "libnobody-has-this.so"}, "install nobody");
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.diagnosis().subject, "libnobody-has-this.so");
    EXPECT_EQ(error.diagnosis().remedy, "install nobody");
  }
  const SharedLibrary c_library({"libnobody-has-this.so.1", "libc.so.6"}, "install libc");
  EXPECT_NE(c_library.symbol<void (*)()>("malloc"), nullptr);
  try {
    static_cast<void>(c_library.symbol<void (*)()>("nobody_has_this"));
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_NE(error.diagnosis().problem.find("nobody_has_this"), std::string::npos);
  }
}

}  // namespace
}  // namespace occlod::gl
