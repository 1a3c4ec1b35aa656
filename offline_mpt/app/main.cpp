#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <new>
#include <string>

#include "command.hpp"
#include "mpi_team.hpp"
#include "offline_mpt/out_of_memory.hpp"
#include "region_maps/error.hpp"

namespace {

const char kFooter[] =
    "Examples:\n"
    "  offline_mpt solve multirotor_lateral.yaml -o lateral.map\n"
    "  offline_mpt count big.json --map-limit 24G\n"
    "  offline_mpt info lateral.map\n"
    "  offline_mpt verify lateral.map --problem multirotor_lateral.yaml --samples 100000 --seed 1\n"
    "  offline_mpt reduce lateral.map -o small.map --separate\n"
    "  offline_mpt plot lateral.map --slice e_p,e_v -o lateral.svg\n"
    "  offline_mpt analyze lateral.map --model lateral_model.yaml\n"
    "  offline_mpt set invariant model.yaml -o safe.json\n"
    "\n"
    "Exit codes:\n"
    "  0  done\n"
    "  1  verification or analysis failed, the partition has a gap, or the answer is no\n"
    "  2  bad file, option or problem; nothing was written\n"
    "  3  interrupted, or a limit was reached; what was kept is said";

bool isCommand(const CLI::App& app, const std::string& name) {
  const auto commands = app.get_subcommands([](const CLI::App*) { return true; });
  return std::any_of(commands.begin(), commands.end(),
                     [&name](const CLI::App* command) { return command->get_name() == name; });
}

// Of the processes of a launcher, which all fail alike, one speaks.
int fail(const char* text) {
  if (polyfly::launchedRank() == 0) std::fprintf(stderr, "offline_mpt: %s\n", text);
  return static_cast<int>(polyfly::ExitCode::kBadInput);
}

}  // namespace

int main(int argc, char** argv) {
  polyfly::endInWordsWithoutMemory("offline_mpt");
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may grow no further is an error of the write that meets it
  CLI::App app("Solves parametric programs into region maps, and looks into such maps.", "offline_mpt");
  app.footer(kFooter);
  app.require_subcommand(1);
  polyfly::ExitCode exit_code = polyfly::ExitCode::kDone;
  polyfly::addSolve(app, exit_code);
  polyfly::addCount(app, exit_code);
  polyfly::addInfo(app, exit_code);
  polyfly::addEval(app, exit_code);
  polyfly::addVerify(app, exit_code);
  polyfly::addReduce(app, exit_code);
  polyfly::addPlot(app, exit_code);
  polyfly::addAnalyze(app, exit_code);
  polyfly::addSet(app, exit_code);
  polyfly::addBounds(app, exit_code);
  if (argc > 1 && argv[1][0] != '-' && !isCommand(app, argv[1])) {
    return fail(("'" + std::string(argv[1]) + "' is no command (see offline_mpt --help)").c_str());
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& request) {  // --help
    return app.exit(request);
  } catch (const CLI::ParseError& error) {
    return fail((std::string(error.what()) + " (see offline_mpt --help)").c_str());
  } catch (const polyfly::Error& error) {
    return fail(error.what());
  } catch (const std::bad_alloc&) {
    return fail("out of memory");
  } catch (const std::exception& error) {
    return fail(error.what());
  }
  return static_cast<int>(exit_code);
}
