#include <pybind11/pybind11.h>

#include "bindings.hpp"
#include "loaded_map.hpp"
#include "outside_error.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly::python {

PYBIND11_MODULE(_polyfly, module) {
  module.doc() = "Explicit MPC: what the package polyfly offers of the C++ libraries.";
  // An exception that derives from another is registered after it: pybind11 asks the last one first.
  const auto& error = pybind11::register_exception<Error>(module, "Error", PyExc_ValueError);
  pybind11::register_exception<OutsideError>(module, "OutsideError", error);
  // Signatures in help texts name the types that are registered by then.
  pybind11::class_<LoadedMap> map(module, "Map",
                                  "A region map: the control law for every parameter in a box.");
  bindSignals(module);
  bindReports(module);
  bindRegions(module);
  bindPrograms(module);
  bindProblems(module);
  bindRobust(module);
  bindMaps(module, map);
}

}  // namespace polyfly::python
