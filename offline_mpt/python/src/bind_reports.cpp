#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <filesystem>

#include "bindings.hpp"
#include "offline_mpt/certify.hpp"
#include "offline_mpt/verify.hpp"
#include "path_caster.hpp"
#include "robust_mpc/prove_map.hpp"

namespace polyfly::python {
namespace {

namespace py = pybind11;
using Path = std::filesystem::path;

void bindVerifyReport(py::module_& module) {
  py::class_<VerifyReport>(module, "VerifyReport",
                           "Samples of a map, compared with the optima of its program.")
      .def_property_readonly(
          "passed", &VerifyReport::passed,
          "Every sample was decided, none breaks a rule, and the map says that it is complete.")
      .def_readonly("samples", &VerifyReport::samples)
      .def_readonly("inside", &VerifyReport::inside, "Samples that the map answers.")
      .def_readonly("compared", &VerifyReport::compared)
      .def_readonly("infeasible", &VerifyReport::infeasible, "Samples at which the program has no solution.")
      .def_readonly("max_error", &VerifyReport::max_error, "Greatest error of u.")
      .def_readonly("max_scaled_error", &VerifyReport::max_scaled_error,
                    "The same, as a share of the input's range.")
      .def_readonly("max_error_theta", &VerifyReport::max_error_theta, "Where that is.")
      .def_readonly("max_error_region", &VerifyReport::max_error_region, "The region that answers there.")
      .def_property_readonly("json", &verifyJson, "The report as JSON.")
      .def("__str__", &verifyText)
      .def("__bool__", &VerifyReport::passed);
}

void bindCertifyReport(py::module_& module) {
  py::class_<Defect>(module, "Defect", "Something that a map gets wrong.")
      .def_property_readonly("kind", [](const Defect& defect) { return toString(defect.kind); })
      .def_readonly("region", &Defect::region)
      .def_readonly("row", &Defect::row, "Row of the region. -1: the whole region.")
      .def_readonly("size", &Defect::size)
      .def_readonly("witness", &Defect::witness, "A parameter. Empty where there is none.")
      .def("__str__", [](const Defect& defect) { return defect.text; });
  py::class_<CertifyReport>(module, "CertifyReport", "What the exact verification of a map found.")
      .def_property_readonly("passed", &CertifyReport::passed)
      .def_readonly("regions", &CertifyReport::regions)
      .def_readonly("facets", &CertifyReport::facets)
      .def_readonly("law_error", &CertifyReport::law_error,
                    "Greatest error of a law, relative to max(1, |u|) or the input's range.")
      .def_readonly("plane_error", &CertifyReport::plane_error, "Greatest error of a plane [scaled].")
      .def_readonly("defects", &CertifyReport::defects)
      .def_readonly("certificate", &CertifyReport::certificate,
                    "Text of the proof, for check_certificate. Empty where there are defects.")
      .def(
          "save",
          [](const CertifyReport& report, const Path& path) { writeCertificate(report, path.string()); },
          py::arg("path"), "Writes the certificate. Raises Error where there is none.")
      .def_property_readonly("json", &certifyJson, "The report as JSON.")
      .def("__str__", &certifyText)
      .def("__bool__", &CertifyReport::passed);
}

}  // namespace

void bindReports(py::module_& module) {
  bindVerifyReport(module);
  bindCertifyReport(module);
  py::class_<RobustSampling>(module, "RobustSampling",
                             "Samples of a robust map, compared with linear programs.")
      .def_property_readonly("passed", &RobustSampling::passed)
      .def_readonly("samples", &RobustSampling::samples)
      .def_readonly("inside", &RobustSampling::inside)
      .def_readonly("status_differs", &RobustSampling::status_differs)
      .def_readonly("input_error", &RobustSampling::input_error,
                    "Greatest error of u, relative to max(1, |u|).")
      .def("__bool__", &RobustSampling::passed);
  py::class_<RobustProof>(module, "RobustProof", "What was proven of a robust map in fractions.")
      .def_property_readonly("passed", &RobustProof::passed)
      .def_property_readonly("recursively_feasible", &RobustProof::recursivelyFeasible)
      .def_readonly("regions", &RobustProof::regions)
      .def_readonly("facets", &RobustProof::facets)
      .def_readonly("vertices", &RobustProof::vertices)
      .def_readonly("law_error", &RobustProof::law_error)
      .def_readonly("plane_error", &RobustProof::plane_error, "[scaled]")
      .def_readonly("defects", &RobustProof::defects)
      .def_readonly("certificate", &RobustProof::certificate,
                    "Text of the proof, for check_certificate. Empty where it does not pass.")
      .def(
          "save", [](const RobustProof& proof, const Path& path) { writeCertificate(proof, path.string()); },
          py::arg("path"), "Writes the certificate. Raises Error where there is none.")
      .def("__bool__", &RobustProof::passed);
}

}  // namespace polyfly::python
