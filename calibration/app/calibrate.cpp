
#include "calibrate_commands.hpp"

int main(int argc, char** argv) {
  CLI::App app("Finds the parameters of a vehicle's model from recorded flights.", "calibrate");
  app.require_subcommand(1);
  int result = polyfly::kCalibrated;
  polyfly::addAttitudeCommand(app, &result);
  polyfly::addMotionCommands(app, &result);
  polyfly::addApplyCommand(app, &result);
  app.footer("Exit code: 0 done, 1 done with warnings and --strict was given, 2 bad input or option.");
  return polyfly::runTool(app, argc, argv, [&] { return result; });
}
