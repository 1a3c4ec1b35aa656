
#include "calibrate_commands.hpp"

int main(int argc, char** argv) {
  CLI::App app("Identifies the parameters of a vehicle's model from recorded flights.", "calibrate");
  app.require_subcommand(1);
  int result = polyfly::kCalibrated;
  polyfly::addAttitudeCommand(app, &result);
  polyfly::addMotionCommands(app, &result);
  polyfly::addApplyCommand(app, &result);
  app.footer(
      "Exit codes: 0 the command succeeded; 1 there were warnings, with --strict; 2 an input or option is "
      "invalid.");
  return polyfly::runTool(app, argc, argv, [&] { return result; });
}
