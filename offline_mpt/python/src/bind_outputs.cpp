#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "arrays.hpp"
#include "bindings.hpp"
#include "explorer_content/explorer_content.hpp"
#include "export_proven/export_proven.hpp"
#include "loaded_map.hpp"
#include "path_caster.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/outputs.hpp"
#include "polyfly_base/write_file.hpp"
#include "watch.hpp"

namespace polyfly::python {
namespace {

namespace py = pybind11;
using Path = std::filesystem::path;

/// Of rows (t, theta).
ExplorerFlight flightOf(const Numbers& samples, const LoadedMap& map) {
  const std::size_t columns = map.parameterCount() + 1;
  const std::size_t count = rowCount(samples, columns, map.map().path() + ": samples");
  ExplorerFlight flight;
  flight.source = "samples";
  for (const double* row = samples.data(); row != samples.data() + count * columns; row += columns) {
    flight.times.push_back(row[0]);
    flight.thetas.insert(flight.thetas.end(), row + 1, row + columns);
  }
  return flight;
}

void explorePage(const LoadedMap& map, const Path& path, const std::optional<Numbers>& samples) {
  std::optional<ExplorerFlight> flight;
  if (samples) flight = flightOf(*samples, map);
  const std::string page = watched(py::none(), [&](Watch&) {
    checkOutputs({{path.string()}}, {map.file()});
    ExplorerContent content = explorerContent(map.map());
    content.flight = std::move(flight);
    return explorerPage(map.map(), content);
  });
  const py::gil_scoped_release release;
  writeFileAtomically(path.string(), page);
}

ExportType exportType(const std::string& name) {
  if (name == "double") return ExportType::kDouble;
  if (name == "float") return ExportType::kFloat;
  if (name == "int16") throw Error(std::string("type: ") + kNoInt16);
  throw Error("type: must be double or float, got '" + name + "'");
}

void exportCode(const LoadedMap& map, const std::string& name, const Path& folder, const std::string& type) {
  ExportOptions options;
  options.name = name;
  options.type = exportType(type);
  const ProvenExport proven = watched(py::none(), [&](Watch& watch) {
    checkExportOutputs(folder.string(), name, {map.file()});
    ExportProofOptions proof;
    proof.stop = &watch.stop();
    proof.progress = [&watch](std::uint64_t pairs) {
      watch.look("compared " + std::to_string(pairs) + " pairs of leaves");
    };
    return proveExport(map.map(), options, proof);
  });
  const py::gil_scoped_release release;
  writeExport(map.map(), proven, folder.string());
}

}  // namespace

void bindOutputs(py::class_<LoadedMap>& type) {
  type.def("explore", &explorePage, py::arg("path"), py::arg("samples") = py::none(),
           "Writes one HTML file that shows the map in any browser. `samples`: a recorded flight, rows of t "
           "[s] and the parameters.")
      .def("export", &exportCode, py::arg("name"), py::arg("folder") = ".", py::arg("type") = "double",
           "Writes the map as C99 code: NAME.c, NAME.h, NAME_test.c, NAME.json. type: double gives the same "
           "answers, float answers within a proven bound. Raises Error and writes nothing where "
           "that cannot "
           "be proven.");
}

}  // namespace polyfly::python
