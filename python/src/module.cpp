// The module occlod._occlod: all that is bound. What users import is the package occlod.
#include <nanobind/nanobind.h>

#include <exception>

#include "bindings.h"
#include "occlod/base.h"
#include "text.h"

namespace occlod::python {
namespace {

// As occlod.Error, with its four parts.
void raise_error(const std::exception_ptr& thrown, void*) {
  try {
    std::rethrow_exception(thrown);
  } catch (const Error& error) {
    const Diagnosis& d = error.diagnosis();
    const nb::object type = nb::module_::import_("occlod._errors").attr("Error");
    const nb::object instance = type(d.subject, d.place, d.problem, d.remedy);
    PyErr_SetObject(type.ptr(), instance.ptr());
  }
}

}  // namespace

std::function<bool(double)> progress_of(nb::handle progress) {
  return [progress](double done) {
    const HeldGil gil;
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
    if (!progress.is_none()) progress(done);
    return true;
  };
}

}  // namespace occlod::python

NB_MODULE(_occlod, m) {
  using namespace occlod::python;
#ifdef NDEBUG
  nanobind::set_leak_warnings(false);  // threads of other packages may hold objects until the end
#endif
  m.doc() = "The C++ library, bound. Import occlod instead.";
  nanobind::register_exception_translator(raise_error);
  handle_exit();
  m.def(
      "version", [] { return std::string(occlod::version()); }, "MAJOR.MINOR.PATCH of the C++ library.");
  bind_materials(m);
  bind_mesh(m);
  bind_simplify(m);
  bind_view(m);
  bind_picture(m);
  bind_hierarchy(m);
  bind_options(m);
  bind_visibility(m);
  bind_refiner(m);
  bind_auto_refiner(m);
  bind_hlod(m);
  bind_tiles(m);
  bind_scene(m);
  bind_device(m);
  bind_traverse(m);
  bind_select(m);
  bind_cells(m);
  bind_cell_files(m);
  bind_cell_walker(m);
}
