// OSMesa, opened at run time. Its header is not needed to build (Mesa dropped the library in 2025): the few
// declarations are repeated here from Mesa 22's GL/osmesa.h.
#include <array>

#include "gl/context_base.h"
#include "gl/shared_library.h"
#include "occlod/core/error.h"

namespace occlod::gl {
namespace {

using OsMesaHandle = struct osmesa_context*;

constexpr int osmesa_format = 0x22;
constexpr int osmesa_profile = 0x33;
constexpr int osmesa_core_profile = 0x34;
constexpr int osmesa_context_major_version = 0x36;
constexpr int osmesa_context_minor_version = 0x37;

struct OsMesa {
  SharedLibrary library{{"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"},
                        "install OSMesa (Debian 12, Ubuntu 24.04: libosmesa6; newer ones have dropped it), or use EGL"};
  OsMesaHandle (*create)(const int*, OsMesaHandle) =
      library.symbol<OsMesaHandle (*)(const int*, OsMesaHandle)>("OSMesaCreateContextAttribs");
  void (*destroy)(OsMesaHandle) = library.symbol<void (*)(OsMesaHandle)>("OSMesaDestroyContext");
  GLboolean (*make_current)(OsMesaHandle, void*, GLenum, GLsizei, GLsizei) =
      library.symbol<GLboolean (*)(OsMesaHandle, void*, GLenum, GLsizei, GLsizei)>("OSMesaMakeCurrent");
  OsMesaHandle (*get_current)() = library.symbol<OsMesaHandle (*)()>("OSMesaGetCurrentContext");
  GetProc get_proc = library.symbol<GetProc>("OSMesaGetProcAddress");
};

const OsMesa& osmesa() {
  static const OsMesa instance;
  return instance;
}

OsMesaHandle create_core_context() {
  constexpr std::array<int, 9> attributes{osmesa_format,
                                          GL_RGBA,
                                          osmesa_profile,
                                          osmesa_core_profile,
                                          osmesa_context_major_version,
                                          3,
                                          osmesa_context_minor_version,
                                          3,
                                          0};
  const OsMesaHandle context = osmesa().create(attributes.data(), nullptr);
  if (context == nullptr)
    throw Error(
        {"OSMesa", "", "no OpenGL 3.3 core context can be made", "install Mesa 17 or newer with llvmpipe, or use EGL"});
  return context;
}

class OsMesaContext final : public ContextBase {
 public:
  OsMesaContext() : ContextBase("osmesa"), context_(create_core_context()) {
    try {
      start(osmesa().get_proc);
    } catch (...) {
      end();
      throw;
    }
  }
  OsMesaContext(const OsMesaContext&) = delete;
  OsMesaContext(OsMesaContext&&) = delete;
  OsMesaContext& operator=(const OsMesaContext&) = delete;
  OsMesaContext& operator=(OsMesaContext&&) = delete;
  ~OsMesaContext() override { end(); }

 protected:
  [[nodiscard]] bool is_current() const noexcept override { return osmesa().get_current() == context_; }
  void bind() override {
    if (osmesa().make_current(context_, window_.data(), GL_UNSIGNED_BYTE, side, side) != GL_TRUE)
      throw Error({"OSMesa", "", "the context cannot be made current", "use it on the thread that made it"});
  }
  void unbind() noexcept override { osmesa().make_current(nullptr, nullptr, GL_UNSIGNED_BYTE, 0, 0); }

 private:
  void end() noexcept {
    retire();
    osmesa().destroy(context_);
  }

  // OSMesa requires a default framebuffer; it is not used.
  static constexpr GLsizei side = 4;
  std::array<unsigned char, std::size_t{side} * side * 4> window_{};
  OsMesaHandle context_;
};

}  // namespace

std::unique_ptr<Context> create_osmesa_context() { return std::make_unique<OsMesaContext>(); }

}  // namespace occlod::gl
