#include "gl/backends.h"

#include <array>
#include <utility>

#include "gl/backend_options.h"
#include "occlod/gl.h"
#include "occlod/visibility.h"
#include "raster/software_occlusion.h"

namespace occlod::gl {
namespace {

std::string name_of(Backend backend) {
  constexpr std::array<const char*, 5> names{"software", "query", "query_conservative", "query_half", "query_third"};
  return names[static_cast<std::size_t>(backend)];
}

int version_needed(Backend backend) { return backend == Backend::query_conservative ? 43 : 33; }

}  // namespace

std::string TestedBackend::label() const {
  return backend == Backend::software ? "software" : name_of(backend) + "_" + platform_label(platform);
}

std::ostream& operator<<(std::ostream& out, const TestedBackend& tested) { return out << tested.label(); }

std::shared_ptr<Context> TestedBackend::context(std::string& why) const {
  if (backend == Backend::software) return nullptr;
  std::shared_ptr<Context> context = context_or_null(platform, why);
  if (!context || context->functions().version >= version_needed(backend)) return context;
  why = "OpenGL " + context->version();
  return nullptr;
}

std::unique_ptr<Visibility> TestedBackend::make(std::shared_ptr<Context> context, bool count_pixels) const {
  if (backend == Backend::software) return make_software_occlusion(count_pixels);
  QueryOcclusionOptions options;
  options.target = count_pixels                             ? QueryTarget::count
                   : backend == Backend::query_conservative ? QueryTarget::any_conservative
                                                            : QueryTarget::any;
  options.divisor = divisor();
  return make_query_occlusion(std::move(context), options);
}

std::vector<TestedBackend> tested_gl_backends() {
  std::vector<TestedBackend> chosen;
  for (const Platform platform : {Platform::egl, Platform::osmesa})
    for (const Backend backend :
         {Backend::query, Backend::query_conservative, Backend::query_half, Backend::query_third})
      chosen.push_back({backend, platform});
  return chosen;
}

std::vector<TestedBackend> tested_backends() {
  std::vector<TestedBackend> chosen = tested_gl_backends();
  chosen.insert(chosen.begin(), {Backend::software, Platform::egl});
  return chosen;
}

void EachBackend::SetUp() {
  std::string why;
  context_ = GetParam().context(why);
  if (!context_ && GetParam().backend != Backend::software) GTEST_SKIP() << "no context: " << why;
}

void EachBackend::start(Visibility& visibility, const Soup& occluder, const glm::dmat4& transform) const {
  const std::array<ObjectView, 1> objects{ObjectView(view_, transform)};
  visibility.begin_view(view_, objects);
  const std::array<OccluderPart, 1> parts{occluder.part()};
  visibility.draw_occluder(parts);
}

}  // namespace occlod::gl
