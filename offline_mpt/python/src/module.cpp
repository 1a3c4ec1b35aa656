#include <pybind11/pybind11.h>

#include "bindings.hpp"
#include "loaded_map.hpp"
#include "outside_error.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/version.hpp"

namespace polyfly::python {
namespace {

PyObject* makeInstance(PyTypeObject* type, PyObject*, PyObject*) {
  return pybind11::detail::make_new_instance(type);
}

/// Type.__new__(Type) would make an object without a value, which reads memory that was never written. Python refuses
/// the __new__ of a base class whose slot is another one. A call of the type uses the slot, and __init__ follows.
void refuseObjectsWithoutValue(const pybind11::module_& module) {
  for (const auto& entry : pybind11::dict(module.attr("__dict__"))) {
    if (!pybind11::isinstance<pybind11::type>(entry.second)) continue;
    auto* const type = reinterpret_cast<PyTypeObject*>(entry.second.ptr());
    if (pybind11::detail::get_type_info(type) == nullptr) continue;
    type->tp_new = makeInstance;
    PyType_Modified(type);
  }
}

}  // namespace

PYBIND11_MODULE(_polyfly, module) {
  module.doc() = "Explicit MPC: what the package polyfly offers of the C++ libraries.";
  module.attr("__version__") = kVersion;
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
  bindDiff(module);
  bindMaps(module, map);
  bindOutputs(map);
  refuseObjectsWithoutValue(module);
}

}  // namespace polyfly::python
