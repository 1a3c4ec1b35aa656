#pragma once

#include "polyfly_base/error.hpp"

namespace polyfly::python {

/// A parameter for which a map or an online program has no answer.
class OutsideError : public Error {
 public:
  using Error::Error;
};

}  // namespace polyfly::python
