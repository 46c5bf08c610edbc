// Converts texts between Python and C++. Names of files and what files hold may be any bytes: those that are not UTF-8
// become lone surrogates in Python, and bytes again in C++, as the names of os.listdir() do (PEP 383). Replaces
// nanobind/stl/string.h.
#pragma once

#include <nanobind/nanobind.h>

#include <string>

namespace nanobind::detail {

template <>
struct type_caster<std::string> {
  NB_TYPE_CASTER(std::string, const_name("str"))

  bool from_python(handle source, std::uint32_t /*flags*/, cleanup_list* /*cleanup*/) noexcept {
    if (!isinstance<str>(source)) return false;
    PyObject* const bytes = PyUnicode_AsEncodedString(source.ptr(), "utf-8", "surrogateescape");
    char* first = nullptr;
    Py_ssize_t size = 0;
    const bool is_text = bytes != nullptr && PyBytes_AsStringAndSize(bytes, &first, &size) == 0;
    if (is_text) value.assign(first, static_cast<std::size_t>(size));
    if (!is_text) PyErr_Clear();
    Py_XDECREF(bytes);
    return is_text;
  }

  static handle from_cpp(const std::string& text, rv_policy /*policy*/, cleanup_list* /*cleanup*/) noexcept {
    return PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), "surrogateescape");
  }
};

}  // namespace nanobind::detail
