// check_problem CERTIFICATE --map MAP [--problem FILE]: confirms that the program of a certificate is the discretised,
// condensed problem of its map. GMP and yaml-cpp only; shares no code with the solver.
#include <cstdio>

#include "arguments.hpp"
#include "files.hpp"
#include "json_problem.hpp"
#include "polyfly_base/out_of_memory.hpp"
#include "polyfly_base/version.hpp"
#include "problem/filter_match.hpp"
#include "problem/program_match.hpp"
#include "problem/robust_match.hpp"
#include "problem/signals.hpp"
#include "robust/read_map_certificate.hpp"

namespace {

constexpr char kUsage[] =
    R"(usage: check_problem CERTIFICATE --map MAP [--problem FILE] [--time-limit SECONDS]
Confirms that the program of CERTIFICATE, from 'offline_mpt verify --exact', is the problem that MAP carries,
discretised and condensed: each row within 1e-12 of its greatest entry, and each input within 1e-6 of its range. What the map answers for that program,
check_certificate confirms. Of a YAML file of type robust_mpc, the model and all rows of the certificate are those of
the file, and its invariant set is one. Of type safety_filter, the safe set is one, and answers in it keep the state
there. Of a program in JSON, each number is compared. Names, units and ranges of the map's parameters and inputs, and
its period, are those of the problem too.
With --problem, MAP must carry the text of that file; of a safety filter, that text and the safe set behind it.
Exit codes: 0 confirmed; 1 refused; 2 the command line or a file is invalid, or memory ran out; 3 stopped at the time limit.
)";

const mpq_class kTolerance(mpz_class(1), mpz_class(1000000000000));

void confirmTracking(const checker::Certificate& certificate, const std::string& text) {
  const checker::ProgramMatch match = checker::matchProgram(certificate.program(), certificate.equalities(),
                                                            checker::readTrackingProblem(text), kTolerance);
  std::printf(
      "confirmed: the program is that of the problem%s, within %.3g of the greatest entry of each row\n"
      "what that may change in an input: at most %.3g of its range\n"
      "the Riccati equation of the terminal weight holds within %.3g\n",
      match.variables == checker::Variables::kInputs ? "" : " beside the feedback of its Riccati gains",
      match.difference.get_d(), match.effect.get_d(), match.riccati_residual.get_d());
}

void confirmRobust(const checker::RobustCertificate& certificate, const std::string& text) {
  const checker::RobustMatch match =
      checker::matchRobust(certificate, checker::readRobustProblem(text), kTolerance);
  std::printf("confirmed: the model is that of the problem, within %.3g; %zu rows follow from it exactly\n",
              match.difference.get_d(), match.rows);
  if (match.invariance_rows > 0)
    std::printf(
        "%zu rows more keep a step in a set within all bounds, which is robustly invariant as long as the "
        "references stay; that no greater set is so is %sconfirmed\n",
        match.invariance_rows, match.is_greatest ? "" : "not ");
}

void confirmFilter(const checker::Certificate& certificate, const checker::Map& map) {
  checker::require(certificate.equalities().empty(), "a safety filter has no equalities");
  const checker::FilterProblem problem = checker::readFilterProblem(map.problem);
  checker::matchFilter(certificate.program(), problem);
  checker::confirmSafeSet(problem, checker::showProgress);
  checker::confirmAnswers(problem, map, checker::showProgress);
  std::printf(
      "confirmed: each number of the program is that of the problem and its safe set\n"
      "safe set, %zu rows: it is within the ranges, each of its states has an admissible input, and each "
      "such "
      "input leads into it, for all disturbances and errors\n"
      "answers in the safe set to wishes in their range: none needs more than the margin, and where no row "
      "is active the wish comes back unchanged\n",
      problem.H.rows);
}

void confirm(const checker::Arguments& arguments) {
  const auto map_file = arguments.find("--map"), problem_file = arguments.find("--problem");
  if (map_file == arguments.end()) throw checker::BadUsage("--map is missing");
  const checker::Map map =
      checker::withFile(map_file->second, [](const std::string& bytes) { return checker::Map(bytes); });
  if (problem_file != arguments.end()) {
    checker::withFile(problem_file->second, [&](const std::string& text) {
      checker::require(text == map.problem || checker::isCompletedText(map.problem, text),
                       "the problem file is not the one that the map was made from");
    });
  }
  checker::require(map.reduced_from == 0,
                   "the map was reduced; check its original, whose answers check_certificate compares");
  const auto certificate = checker::readMapCertificate(checker::readFile(arguments.at("")), map);
  const auto* const robust = dynamic_cast<const checker::RobustCertificate*>(certificate.get());
  if (robust != nullptr) {
    confirmRobust(*robust, map.problem);
  } else if (map.kind() == "json") {
    checker::compareProblem(*certificate, map, map.problem);
    std::printf("confirmed: each number of the program is that of the problem\n");
  } else if (checker::problemType(map.problem) == "safety_filter") {
    confirmFilter(*certificate, map);
  } else {
    confirmTracking(*certificate, map.problem);
  }
  checker::matchSignals(map, map.problem);
  std::printf("the map's signals, ranges and period are those of the problem\n");
}

}  // namespace

int main(int argc, char** argv) {
  polyfly::installOutOfMemoryHandler("check_problem");
  return checker::run({"check_problem", polyfly::kVersion, kUsage, {"--map", "--problem"}}, argc, argv,
                      confirm);
}
