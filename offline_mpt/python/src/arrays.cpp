#include "arrays.hpp"

#include "polyfly_base/error.hpp"

namespace polyfly::python {
namespace {

std::string shapeText(const Numbers& array) {
  std::string text;
  for (pybind11::ssize_t i = 0; i < array.ndim(); ++i)
    text += (i == 0 ? "" : " x ") + std::to_string(array.shape(i));
  return array.ndim() == 0 ? "one number" : text;
}

}  // namespace

const double* parameterOf(const Numbers& theta, std::size_t p, const std::string& name) {
  if (theta.ndim() != 1 || static_cast<std::size_t>(theta.shape(0)) != p)
    throw Error(name + ": theta: must have " + std::to_string(p) + " numbers, got " + shapeText(theta));
  return theta.data();
}

std::size_t parameterRows(const Numbers& thetas, std::size_t p, const std::string& name) {
  if (thetas.ndim() != 2 || static_cast<std::size_t>(thetas.shape(1)) != p)
    throw Error(name + ": thetas: must have rows of " + std::to_string(p) + " numbers, got " +
                shapeText(thetas));
  return static_cast<std::size_t>(thetas.shape(0));
}

}  // namespace polyfly::python
