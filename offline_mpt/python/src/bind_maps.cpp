#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "arrays.hpp"
#include "bindings.hpp"
#include "map_plot/figure.hpp"
#include "map_plot/slice.hpp"
#include "map_region.hpp"
#include "offline_mpt/reduce_proven.hpp"
#include "path_caster.hpp"
#include "prove.hpp"
#include "solve.hpp"
#include "watch.hpp"

namespace polyfly::python {
namespace {

namespace py = pybind11;
using Path = std::filesystem::path;

// Look-ups between two questions whether Ctrl-C was pressed.
constexpr std::size_t kBlock = std::size_t{1} << 22;

// Runs work(first, count) on blocks of `count` look-ups without Python's lock.
template <class Work>
void inBlocks(std::size_t count, const Work& work) {
  for (std::size_t first = 0; first < count; first += kBlock) {
    {
      const py::gil_scoped_release release;
      work(first, std::min(kBlock, count - first));
    }
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  }
}

py::array_t<double> call(const LoadedMap& map, const Numbers& theta) {
  const double* numbers = parameterOf(theta, map.parameterCount(), map.map().path());
  py::array_t<double> u(static_cast<py::ssize_t>(map.inputCount()));
  map.evaluate(numbers, u.mutable_data());
  return u;
}

py::array_t<double> evaluate(const LoadedMap& map, const Numbers& thetas, int threads) {
  const std::size_t p = map.parameterCount();
  const std::size_t m = map.inputCount();
  const std::size_t count = parameterRows(thetas, p, map.map().path());
  const int workers = threadCount(threads);
  py::array_t<double> u({count, m});
  const double* from = thetas.data();
  double* to = u.mutable_data();
  inBlocks(count, [&](std::size_t first, std::size_t size) {
    map.evaluateMany(from + first * p, size, workers, to + first * m);
  });
  return u;
}

py::array_t<std::int64_t> locate(const LoadedMap& map, const Numbers& thetas, int threads) {
  const std::size_t p = map.parameterCount();
  const std::size_t count = parameterRows(thetas, p, map.map().path());
  const int workers = threadCount(threads);
  py::array_t<std::int64_t> regions(static_cast<py::ssize_t>(count));
  const double* from = thetas.data();
  std::int64_t* to = regions.mutable_data();
  inBlocks(count, [&](std::size_t first, std::size_t size) {
    map.locateMany(from + first * p, size, workers, to + first);
  });
  return regions;
}

py::array gainOf(const py::object& self, std::size_t law) {
  const LoadedMap& map = self.cast<const LoadedMap&>();
  const auto p = static_cast<py::ssize_t>(map.parameterCount());
  const auto m = static_cast<py::ssize_t>(map.inputCount());
  constexpr auto kNumber = static_cast<py::ssize_t>(sizeof(double));
  return view(map.map().law(law), {m, p}, self, {(p + 1) * kNumber, kNumber});
}

py::array jacobian(const py::object& self, const Numbers& theta) {
  const LoadedMap& map = self.cast<const LoadedMap&>();
  return gainOf(self, map.locate(parameterOf(theta, map.parameterCount(), map.map().path())).law);
}

py::array planes(const py::object& self) {
  const LoadedMap& map = self.cast<const LoadedMap&>();
  return view(
      map.map().plane(0),
      {static_cast<py::ssize_t>(map.map().planeCount()), static_cast<py::ssize_t>(map.parameterCount() + 1)},
      self);
}

py::array laws(const py::object& self) {
  const LoadedMap& map = self.cast<const LoadedMap&>();
  return view(map.map().law(0),
              {static_cast<py::ssize_t>(map.map().lawCount()), static_cast<py::ssize_t>(map.inputCount()),
               static_cast<py::ssize_t>(map.parameterCount() + 1)},
              self);
}

/// Options that were removed are refused with what to use instead.
void refuseRemoved(const py::kwargs& others) {
  for (const auto& [name, text] : {std::pair{"merge", kNoMerge}, std::pair{"separate", kNoSeparate}}) {
    if (others.contains(name)) throw Error(std::string(name) + ": " + text);
  }
  for (const auto& [name, value] : others)
    throw py::type_error("reduce() has no argument " + py::cast<std::string>(name));
}

std::unique_ptr<LoadedMap> reduceMap(const LoadedMap& map, const std::string& tree, int threads,
                                     py::object progress, const py::kwargs& others) {
  refuseRemoved(others);
  const std::string name = map.map().path() + ", reduced";
  ProvenReduction proven = watched(std::move(progress), [&](Watch& watch) {
    ReduceOptions reduce;
    reduce.tree = treeMode(tree, {TreeMode::kAuto, TreeMode::kSmall});
    reduce.threads = threadCount(threads);
    reduce.stop = &watch.stop();
    reduce.progress = [&](auto done, auto total) {
      watch.look("joined regions of " + shareText(done, total, "laws"));
    };
    reduce.tree_progress = [&](auto done, auto) {
      watch.look("search tree, " + std::to_string(done) + " nodes");
    };
    ReductionOptions proof;
    proof.threads = reduce.threads;
    proof.stop = &watch.stop();
    proof.progress = [&](auto done, auto total) {
      watch.look("proof: " + shareText(done, total, "regions"));
    };
    return reduceProven(map.map(), name, reduce, proof);
  });
  if (!proven.report.passed()) throw Error(name + ": the reduced map could not be proven");
  return std::make_unique<LoadedMap>(std::move(proven.image), name);
}

/// A drawing, before it is rendered.
struct Picture {
  Figure figure;

  std::string svg() const {
    const py::gil_scoped_release release;
    return renderFigure(figure, ImageFormat::kSvg);
  }
  void save(const Path& path) const {
    const py::gil_scoped_release release;
    writeFigure(figure, path.string());
  }
};

Picture plot(const LoadedMap& map, const std::string& x, const std::string& y,
             const std::optional<Path>& output, const std::map<std::string, double>& at) {
  SliceRequest request;
  request.x = x;
  request.y = y;
  request.at.assign(at.begin(), at.end());
  Picture picture{sliceFigure(map.map(), request)};
  if (output) picture.save(*output);
  return picture;
}

py::dict cost(const LoadedMap& map) {
  py::dict result;
  result["depth"] = map.map().cost().depth;
  result["region_checks"] = map.map().cost().region_checks;
  result["multiply_adds"] = map.map().cost().multiply_adds;
  return result;
}

std::string represent(const LoadedMap& map) {
  return "<polyfly.Map " + map.map().path() + ": " + std::string(map.map().solverStatus()) + ", " +
         std::to_string(map.map().regionCount()) + " regions, " + std::to_string(map.parameterCount()) +
         " parameters, " + std::to_string(map.inputCount()) + " inputs>";
}

void defineFacts(py::class_<LoadedMap>& type) {
  const auto text = [](std::string_view (RegionMap::*get)() const noexcept) {
    return [get](const LoadedMap& map) { return std::string((map.map().*get)()); };
  };
  type.def_property_readonly("name", text(&RegionMap::name))
      .def_property_readonly("status", text(&RegionMap::solverStatus),
                             "Status of the solver: 'complete', 'limited', ...")
      .def_property_readonly("notes", text(&RegionMap::solverNotes),
                             "Facts about the solution, lines `key: value`.")
      .def_property_readonly("problem_text", text(&RegionMap::problemText),
                             "Text of the problem file, verbatim.")
      .def_property_readonly("problem_kind", text(&RegionMap::problemKind), "'yaml' or 'json'.")
      .def_property_readonly("path", [](const LoadedMap& map) { return map.map().path(); })
      .def_property_readonly(
          "period", [](const LoadedMap& map) { return map.map().period(); },
          "Sampling time of the controller [s]. 0: none.")
      .def_property_readonly(
          "tolerance", [](const LoadedMap& map) { return map.map().tolerance(); },
          "Distance outside a half-space at which a parameter counts as inside [scaled].")
      .def_property_readonly("parameters", [](const LoadedMap& map) { return map.map().parameters(); })
      .def_property_readonly("inputs", [](const LoadedMap& map) { return map.map().inputs(); })
      .def_property_readonly(
          "bytes", [](const LoadedMap& map) { return map.map().bytes(); }, "Size of the file.")
      .def_property_readonly("checksum", [](const LoadedMap& map) { return map.map().checksum(); })
      .def_property_readonly(
          "reduced_from", [](const LoadedMap& map) { return map.map().reducedFrom(); },
          "Checksum of the map that this one was reduced from. 0: none.")
      .def_property_readonly("cost", &cost, "Bounds on one look-up: depth, region_checks, multiply_adds.")
      .def_property_readonly("planes", &planes, "Planes a . theta <= c, rows (a, c): a view of the file.")
      .def_property_readonly("laws", &laws,
                             "Laws u = K theta + k, rows (K, k) for each input: a view of the file.");
}

}  // namespace

void bindMaps(py::module_& module, py::class_<LoadedMap>& type) {
  py::class_<Picture>(module, "Picture", "A drawing of a map.")
      .def_property_readonly("svg", &Picture::svg, "Text of the SVG file.")
      .def("_repr_svg_", &Picture::svg)
      .def("save", &Picture::save, py::arg("path"), "Writes a .svg or .png file.");
  defineFacts(type);
  type.def("__call__", &call, py::arg("theta"),
           "Input u at theta. Raises OutsideError where the map has none.")
      .def("evaluate", &evaluate, py::arg("thetas"), py::arg("threads") = 1,
           "Inputs at many parameters, a row each; NaN where the map has none. threads=0: all processors.")
      .def("locate", &locate, py::arg("thetas"), py::arg("threads") = 1,
           "Regions that hold the parameters; -1 where none does.")
      .def("jacobian", &jacobian, py::arg("theta"),
           "du/dtheta: the gain K of the region that holds theta, exact; on a face, of the one that the "
           "look-up finds.")
      .def("program", &LoadedMap::program, "The parametric program, from the problem text in the map.")
      .def(
          "save", [](const LoadedMap& map, const Path& path) { map.save(path.string()); }, py::arg("path"),
          "Writes the map file: whole or not at all.")
      .def("reduce", &reduceMap, py::kw_only(), py::arg("tree") = "auto", py::arg("threads") = 0,
           py::arg("progress") = py::none(),
           "A smaller map, proven to give the same answers. tree: auto, or small: as far as it shortens "
           "look-ups.")
      .def("verify", &verifyMap, py::kw_only(), py::arg("samples") = 10000, py::arg("seed") = 1,
           py::arg("tolerance") = 1e-7, py::arg("threads") = 0, py::arg("progress") = py::none(),
           "Compares the map with direct solutions of its problem at random parameters.")
      .def("certify", &certifyMap, py::kw_only(), py::arg("threads") = 0, py::arg("progress") = py::none(),
           "Proves or refutes the map in rational arithmetic.")
      .def("plot", &plot, py::arg("x"), py::arg("y"), py::arg("output") = py::none(),
           py::arg("at") = std::map<std::string, double>(),
           "A slice over two parameters, drawn by gnuplot; written where `output` (.svg, .png) is given. "
           "`at`: values of "
           "the others by name, else 0 or the middle of the range.")
      .def_property_readonly(
          "regions",
          py::cpp_function([](const LoadedMap& map) { return RegionList{&map}; }, py::keep_alive<0, 1>()),
          "The critical regions, in file order.")
      .def("__repr__", &represent);
  module.def(
      "open", [](const Path& path) { return std::make_unique<LoadedMap>(path.string()); }, py::arg("path"),
      "Maps a map file into memory and checks it. Raises Error with the file and the rule that it breaks.");
}

}  // namespace polyfly::python
