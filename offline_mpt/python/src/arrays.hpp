#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cstdint>
#include <string>
#include <vector>

#include "region_maps/signal.hpp"

namespace polyfly::python {

/// Numbers from Python: row-major doubles, converted where they are not.
using Numbers = pybind11::array_t<double, pybind11::array::c_style | pybind11::array::forcecast>;

/// Read-only array over memory that `owner` keeps. Strides in bytes; none: row-major.
template <class Number>
pybind11::array_t<Number> view(const Number* data, std::vector<pybind11::ssize_t> shape,
                               pybind11::handle owner, std::vector<pybind11::ssize_t> strides = {}) {
  pybind11::array_t<Number> result(std::move(shape), std::move(strides), data, owner);
  result.attr("setflags")(pybind11::arg("write") = false);
  return result;
}

/// The p numbers of one parameter. Throws Error `name: theta: rule`.
const double* parameterOf(const Numbers& theta, std::size_t p, const std::string& name);

/// Number of rows of an array with `columns` numbers each. Throws Error `field: rule`.
std::size_t rowCount(const Numbers& array, std::size_t columns, const std::string& field);

/// Number of rows of an array of parameters, p numbers each. Throws Error `name: thetas: rule`.
std::size_t parameterRows(const Numbers& thetas, std::size_t p, const std::string& name);

}  // namespace polyfly::python
