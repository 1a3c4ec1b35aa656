#pragma once

#include <stdexcept>
#include <string>

namespace polyfly {

/// Bad input met during set-up: a file, a field or an option that breaks a rule. The text names all
/// three, for example `lateral.yaml:12: horizon: must be at least 1, got 0`. Never thrown in flight.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace polyfly
