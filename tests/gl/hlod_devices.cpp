// The device `gl` in the suite that every device has to pass.
#include "device/tested_devices.h"
#include "gl/support.h"
#include "occlod/gl.h"

namespace occlod::hlod::test {

std::vector<TestedDevice> tested_devices() {
  std::vector<TestedDevice> devices;
  for (const gl::Platform platform : {gl::Platform::egl, gl::Platform::osmesa})
    for (const bool quality : {false, true})
      devices.push_back({"gl_" + gl::platform_label(platform) + (quality ? "_quality" : ""),
                         [platform, quality](std::string& why) -> std::unique_ptr<RenderDevice> {
                           std::shared_ptr<gl::Context> context = gl::context_or_null(platform, why);
                           if (!context) return nullptr;
                           return gl::make_hlod_device(std::move(context), {.quality = quality});
                         },
                         quality});
  return devices;
}

}  // namespace occlod::hlod::test
