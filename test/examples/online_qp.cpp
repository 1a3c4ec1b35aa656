// Solves the problem online at one parameter, without a map: online_qp PROBLEM THETA...
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "mpc_core/mpc_problem.hpp"
#include "mpc_core/online_program.hpp"
#include "polyfly_base/error.hpp"

int main(int argc, char** argv) try {
  if (argc < 2) {
    std::fprintf(stderr, "usage: online_qp PROBLEM THETA...\n");
    return 2;
  }
  polyfly::OnlineProgram online(polyfly::loadProgram(argv[1]));
  std::vector<double> theta;
  for (int i = 2; i < argc; ++i) theta.push_back(std::strtod(argv[i], nullptr));
  if (static_cast<int>(theta.size()) != online.program().parameterCount()) {
    std::fprintf(stderr, "%s has %d parameters\n", argv[1], online.program().parameterCount());
    return 2;
  }
  std::vector<double> u(static_cast<std::size_t>(online.program().inputCount()));
  if (online.solve(theta.data(), u.data()) != polyfly::QpStatus::kOptimal) {
    std::printf("no solution\n");
    return 1;
  }
  for (const double value : u) std::printf("%.17g\n", value);
  return 0;
} catch (const polyfly::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
