
#include <CLI/CLI.hpp>

#include "calibrate_commands.hpp"
#include "polyfly_base/error.hpp"

namespace {

/// A command that is gone, and what to use in its place.
struct RemovedCommand {
  const char* name;
  const char* instead;
};

constexpr RemovedCommand kRemovedCommands[] = {
    {"heading",
     "compare the direction of acceleration with that of tilt by hand, as calibration/README.md says"},
    {"thrust",
     "'calibrate mass' finds the command that hovers, which is output/hover_thrust; write a bent curve as "
     "output/thrust_polynomial by hand"},
    {"wind", "fly circles, and take the mean of the velocity over ground"},
};

/// Removed commands are not listed. They take any arguments, and are refused.
void addRemoved(CLI::App& app) {
  for (const RemovedCommand& removed : kRemovedCommands) {
    CLI::App* command = app.add_subcommand(removed.name, "")->group("");
    command->allow_extras()->prefix_command();
    const std::string text = std::string(removed.name) + ": was removed; " + removed.instead;
    command->callback([text] { throw polyfly::Error(text); });
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Identifies the parameters of a vehicle's model from recorded flights.", "calibrate");
  app.require_subcommand(1);
  int result = polyfly::kCalibrated;
  polyfly::addAttitudeCommand(app, &result);
  polyfly::addMotionCommands(app, &result);
  polyfly::addApplyCommand(app, &result);
  addRemoved(app);
  app.footer(
      "Exit codes: 0 the command succeeded; 1 there were warnings, with --strict; 2 an input or option is "
      "invalid.");
  return polyfly::runTool(app, argc, argv, [&] { return result; });
}
