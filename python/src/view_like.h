// An argument that is a View or a Camera.
#pragma once

#include <nanobind/nanobind.h>

#include "occlod/view.h"

namespace occlod::python {

struct ViewLike {
  const View* view = nullptr;      // else
  const Camera* camera = nullptr;  // both live as long as the call

  // Throws what View() throws.
  [[nodiscard]] View get() const { return view != nullptr ? *view : View(*camera); }
};

}  // namespace occlod::python

namespace nanobind::detail {

template <>
struct type_caster<occlod::python::ViewLike> {
  NB_TYPE_CASTER(occlod::python::ViewLike, const_name("View | Camera"))

  bool from_python(handle source, std::uint8_t, cleanup_list*) noexcept {
    if (isinstance<occlod::View>(source)) {
      value.view = inst_ptr<occlod::View>(source);
      return true;
    }
    if (!isinstance<occlod::Camera>(source)) return false;
    value.camera = inst_ptr<occlod::Camera>(source);
    return true;
  }
};

}  // namespace nanobind::detail
