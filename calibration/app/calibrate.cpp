#include <CLI/CLI.hpp>
#include <iostream>
#include <new>

#include "calibrate_commands.hpp"
#include "region_maps/error.hpp"

int main(int argc, char** argv) {
  CLI::App app("Finds the parameters of a vehicle's model from recorded flights.", "calibrate");
  app.require_subcommand(1);
  int result = polyfly::kCalibrated;
  polyfly::addAttitudeCommand(app, &result);
  polyfly::addMotionCommands(app, &result);
  polyfly::addApplyCommand(app, &result);
  app.footer("Exit code: 0 done, 1 done with warnings and --strict was given, 2 bad input or option.");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? polyfly::kCalibrated : polyfly::kBadInput;
  } catch (const std::bad_alloc&) {
    std::cerr << "calibrate: out of memory\n";
    return polyfly::kBadInput;
  } catch (const std::exception& error) {
    std::cerr << "calibrate: " << error.what() << "\n";
    return polyfly::kBadInput;
  }
  return result;
}
