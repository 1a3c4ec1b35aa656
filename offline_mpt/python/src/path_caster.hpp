#pragma once

#include <pybind11/pybind11.h>

#include <filesystem>
#include <string>

/// A path from a str, bytes, or an object with __fspath__. pybind11 has it since 2.8.
template <>
struct pybind11::detail::type_caster<std::filesystem::path> {
  PYBIND11_TYPE_CASTER(std::filesystem::path, _("os.PathLike"));

  bool load(handle source, bool /*convert*/) {
    PyObject* text = nullptr;
    if (PyUnicode_FSConverter(source.ptr(), &text) == 0) {
      PyErr_Clear();
      return false;
    }
    value = std::string(reinterpret_steal<bytes>(text));
    return true;
  }
};
