// Links: whether there is a driver here is not the question.
#include <occlod/base.h>
#include <occlod/gl.h>

#include <cstdio>
#include <memory>

int main() try {
  const std::shared_ptr<occlod::gl::Context> context = occlod::gl::create_any_context();
  const auto visibility = occlod::gl::make_query_occlusion(context);
  std::printf("%s\n", context->renderer().c_str());
} catch (const occlod::Error& error) {
  std::printf("%s\n", error.what());
}
