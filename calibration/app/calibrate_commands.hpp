#pragma once

#include "command_line/command_line.hpp"

namespace polyfly {

// Exit codes of `calibrate`.
constexpr int kCalibrated = 0;
constexpr int kWarned = 1;
constexpr int kBadInput = 2;

/// Adds `attitude` to the tool; running it stores its exit code.
void addAttitudeCommand(CLI::App& app, int* result);

/// Adds `disturbance`, `drag` and `mass`.
void addMotionCommands(CLI::App& app, int* result);

/// Adds `apply`.
void addApplyCommand(CLI::App& app, int* result);

}  // namespace polyfly
