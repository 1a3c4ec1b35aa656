#include <pybind11/pybind11.h>

#include <sstream>

#include "bindings.hpp"
#include "region_maps/signal.hpp"

namespace polyfly::python {

namespace py = pybind11;

void bindSignals(py::module_& module) {
  py::class_<Signal>(module, "Signal", "One named entry of a parameter or input vector.")
      .def_readonly("name", &Signal::name)
      .def_readonly("unit", &Signal::unit, "SI or rad, as text.")
      .def_readonly("lower", &Signal::lower, "Least admissible value [unit].")
      .def_readonly("upper", &Signal::upper, "Greatest admissible value [unit].")
      .def("__repr__", [](const Signal& signal) {
        std::ostringstream text;
        text << signal.name << " [" << signal.unit << "] " << signal.lower << " .. " << signal.upper;
        return text.str();
      });
}

}  // namespace polyfly::python
