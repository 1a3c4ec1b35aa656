#pragma once

#include <pybind11/pybind11.h>

namespace polyfly::python {

class LoadedMap;

/// Each adds its types and functions to the module.
void bindSignals(pybind11::module_& module);
void bindReports(pybind11::module_& module);
void bindRegions(pybind11::module_& module);
void bindPrograms(pybind11::module_& module);
void bindProblems(pybind11::module_& module);
void bindRobust(pybind11::module_& module);
void bindMaps(pybind11::module_& module, pybind11::class_<LoadedMap>& type);

}  // namespace polyfly::python
