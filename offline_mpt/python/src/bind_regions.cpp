#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "map_region.hpp"
#include "polytope_sets/analyze_map.hpp"

namespace polyfly::python {
namespace {

namespace py = pybind11;

// Exact vertices that are nearer to each other stand for one: rounded planes rarely meet in one point [scaled].
constexpr double kSameVertex = 1e-7;

MapRegion regionAt(const RegionList& list, py::ssize_t index) {
  const auto count = static_cast<py::ssize_t>(list.map->map().regionCount());
  if (index < -count || index >= count)
    throw py::index_error("region " + std::to_string(index) + " of " + std::to_string(count));
  return {list.map, static_cast<std::size_t>(index < 0 ? index + count : index)};
}

py::array_t<double> halfSpaces(const MapRegion& region) {
  const std::size_t columns = region.map->parameterCount() + 1;
  py::array_t<double> rows({std::size_t{region.data().row_count}, columns});
  double* to = rows.mutable_data();
  for (std::uint32_t row = 0; row < region.data().row_count; ++row) {
    const std::int32_t reference = region.data().rows[row];
    const double* plane = region.map->map().plane(static_cast<std::size_t>(std::abs(reference)) - 1);
    for (std::size_t i = 0; i < columns; ++i) *to++ = reference > 0 ? plane[i] : -plane[i];
  }
  return rows;
}

bool areSame(const std::vector<Signal>& parameters, const double* a, const double* b) {
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const double half = 0.5 * (parameters[i].upper - parameters[i].lower);
    if (std::abs(a[i] - b[i]) > kSameVertex * half) return false;
  }
  return true;
}

py::array_t<double> verticesOf(const MapRegion& region) {
  const std::vector<Signal>& parameters = region.map->map().parameters();
  const std::size_t p = parameters.size();
  std::vector<double> kept;
  {
    const py::gil_scoped_release release;
    for (const RationalVector& vertex : vertices(regionPolytope(region.map->map(), region.index))) {
      std::vector<double> point;
      for (const Rational& value : vertex) point.push_back(nearestDouble(value));
      bool is_new = true;
      for (std::size_t at = 0; at < kept.size() && is_new; at += p)
        is_new = !areSame(parameters, &kept[at], point.data());
      if (is_new) kept.insert(kept.end(), point.begin(), point.end());
    }
  }
  py::array_t<double> result({kept.size() / p, p});
  std::copy(kept.begin(), kept.end(), result.mutable_data());
  return result;
}

constexpr auto kNumber = static_cast<py::ssize_t>(sizeof(double));

py::array gain(const py::object& self) {
  const MapRegion& region = self.cast<const MapRegion&>();
  const auto p = static_cast<py::ssize_t>(region.map->parameterCount());
  const auto m = static_cast<py::ssize_t>(region.map->inputCount());
  return view(region.map->map().law(region.data().law), {m, p}, self, {(p + 1) * kNumber, kNumber});
}

py::array offset(const py::object& self) {
  const MapRegion& region = self.cast<const MapRegion&>();
  const auto p = static_cast<py::ssize_t>(region.map->parameterCount());
  const auto m = static_cast<py::ssize_t>(region.map->inputCount());
  return view(region.map->map().law(region.data().law) + p, {m}, self, {(p + 1) * kNumber});
}

py::array active(const py::object& self) {
  const RegionView region = self.cast<const MapRegion&>().data();
  return view(region.active, {static_cast<py::ssize_t>(region.active_count)}, self);
}

bool holds(const MapRegion& region, const Numbers& theta) {
  const LoadedMap& map = *region.map;
  return map.map().contains(region.index, parameterOf(theta, map.parameterCount(), map.map().path()));
}

}  // namespace

void bindRegions(py::module_& module) {
  py::class_<MapRegion>(module, "Region",
                        "A critical region: half_spaces (a, c) with a . theta <= c, and u = K theta + k.")
      .def_readonly("index", &MapRegion::index)
      .def_property_readonly(
          "law", [](const MapRegion& region) { return region.data().law; }, "Index among the laws.")
      .def_property_readonly("active", &active,
                             "The active set: row numbers of the program, a view of the file.")
      .def_property_readonly("half_spaces", &halfSpaces,
                             "Rows (a, c) of a . theta <= c, in the parameters' units.")
      .def_property_readonly("K", &gain, "Gain, inputs x parameters: a view of the file.")
      .def_property_readonly("k", &offset, "Offset, inputs: a view of the file.")
      .def_property_readonly(
          "vertices", &verticesOf,
          "Vertices, a row each, in the parameters' units: exact, then rounded. Vertices within 1e-7 of "
          "the ranges' halves count once.")
      .def("contains", &holds, py::arg("theta"),
           "Whether theta lies in the region within the map's tolerance.")
      .def("__repr__", [](const MapRegion& region) {
        return "<polyfly.Region " + std::to_string(region.index) + ": " +
               std::to_string(region.data().row_count) + " half-spaces, law " +
               std::to_string(region.data().law) + ">";
      });
  py::class_<RegionList>(module, "RegionList", "The regions of a map.")
      .def("__len__", [](const RegionList& list) { return list.map->map().regionCount(); })
      .def("__getitem__", &regionAt, py::arg("index"), py::keep_alive<0, 1>());
}

}  // namespace polyfly::python
