#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "bindings.hpp"
#include "loaded_map.hpp"
#include "offline_mpt/diff.hpp"
#include "polyfly_base/error.hpp"
#include "watch.hpp"

namespace polyfly::python {
namespace {

namespace py = pybind11;

/// A report with the names of the inputs, which its texts need.
struct NamedDiff : DiffReport {
  std::vector<std::string> inputs;
};

NamedDiff diff(const LoadedMap& first, const LoadedMap& second, double tolerance, int threads,
               py::object progress) {
  if (!(tolerance >= 0.0) || !std::isfinite(tolerance)) {
    throw Error("tolerance: must be a finite number of at least 0, got " + std::to_string(tolerance));
  }
  const int workers = threadCount(threads);
  NamedDiff result{watched(std::move(progress),
                           [&](Watch& watch) {
                             DiffOptions options;
                             options.threads = workers;
                             options.tolerance = tolerance;
                             options.stop = &watch.stop();
                             options.progress = [&](auto done, auto total) {
                               watch.look("compared " + shareText(done, total, "regions"));
                             };
                             return diffMaps(first.map(), second.map(), options);
                           }),
                   {}};
  for (const Signal& input : first.map().inputs()) result.inputs.push_back(input.name);
  return result;
}

void bindParts(py::module_& module) {
  py::class_<LawDifference>(module, "LawDifference", "Where two regions meet, and how far their laws differ.")
      .def_readonly("input", &LawDifference::input, "Index of the input.")
      .def_readonly("first_region", &LawDifference::first_region)
      .def_readonly("second_region", &LawDifference::second_region)
      .def_readonly("size", &LawDifference::size,
                    "Greatest difference over their common part [unit of the input].")
      .def_readonly("theta", &LawDifference::theta, "Where it is reached. Empty where no regions meet.");
  py::class_<MapCover>(module, "MapCover", "Whether a map answers wherever another one does.")
      .def_readonly("covers", &MapCover::covers)
      .def_readonly("region", &MapCover::region,
                    "Where it does not: a region of the other map with the witness.")
      .def_readonly("witness", &MapCover::witness, "A parameter that the map does not answer. Empty: none.")
      .def("__bool__", [](const MapCover& cover) { return cover.covers; });
}

}  // namespace

void bindDiff(py::module_& module) {
  bindParts(module);
  py::class_<NamedDiff>(module, "DiffReport",
                        "Where and by how much at most two maps differ, in rational arithmetic.")
      .def_property_readonly("same", &NamedDiff::same, "The same answers within the tolerance, everywhere.")
      .def_readonly("first_regions", &NamedDiff::first_regions)
      .def_readonly("second_regions", &NamedDiff::second_regions)
      .def_readonly("pairs", &NamedDiff::pairs, "Pairs of regions that meet.")
      .def_readonly("different_pairs", &NamedDiff::different_pairs,
                    "Of these: their laws differ by more than the tolerance.")
      .def_readonly("tolerance", &NamedDiff::tolerance)
      .def_readonly("greatest", &NamedDiff::greatest, "The greatest difference of each input.")
      .def_readonly("differences", &NamedDiff::differences, "Differences above the tolerance.")
      .def_readonly("first_covers_second", &NamedDiff::first_covers_second)
      .def_readonly("second_covers_first", &NamedDiff::second_covers_first)
      .def_property_readonly(
          "json", [](const NamedDiff& report) { return diffJson(report, report.inputs); },
          "The report as JSON.")
      .def("__str__", [](const NamedDiff& report) { return diffText(report, report.inputs); })
      .def("__bool__", &NamedDiff::same);
  module.def(
      "diff", &diff, py::arg("a"), py::arg("b"), py::arg("tolerance") = DiffOptions{}.tolerance,
      py::kw_only(), py::arg("threads") = 0, py::arg("progress") = py::none(),
      "Compares two maps of the same parameters and inputs; returns a DiffReport. Differences of u up to "
      "tolerance [unit of u] count as none.");
}

}  // namespace polyfly::python
