#pragma once

#include <string>

#include "polyfly_base/error.hpp"

/// For the tests of all packages.
namespace polyfly {

/// What the Error says that `action` throws; "no error" when it throws none.
template <class Action>
std::string errorOf(const Action& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace polyfly
