
#include "calibrate_commands.hpp"

int main(int argc, char** argv) {
  CLI::App app("Identifies the parameters of a vehicle's model from recorded flights.", "calibrate");
  app.require_subcommand(1);
  int result = polyfly::kCalibrated;
  polyfly::addAttitudeCommand(app, &result);
  polyfly::addMotionCommands(app, &result);
  polyfly::addApplyCommand(app, &result);
  polyfly::addRemoved(app, {"heading"},
                      "was removed; compare the direction of acceleration with that of tilt by hand, as "
                      "calibration/README.md says");
  polyfly::addRemoved(app, {"thrust"},
                      "was removed; 'calibrate mass' finds the command that hovers, which is "
                      "output/hover_thrust; write a bent curve as output/thrust_polynomial by hand");
  polyfly::addRemoved(app, {"wind"},
                      "was removed; fly circles, and take the mean of the velocity over ground");
  app.footer(
      "Exit codes: 0 the command succeeded; 1 there were warnings, with --strict; 2 an input or option is "
      "invalid.");
  return polyfly::runTool(app, argc, argv, [&] { return result; });
}
