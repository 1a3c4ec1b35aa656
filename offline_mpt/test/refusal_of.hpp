#pragma once

#include <string>

#include "core/text.hpp"

namespace polyfly {

/// What the checker says where `action` makes it refuse; empty where it does not.
template <class Action>
std::string refusalOf(const Action& action) {
  try {
    action();
  } catch (const checker::Refused& error) {
    return error.what();
  }
  return "";
}

}  // namespace polyfly
