// check_count PROOF [--problem FILE] [--map-limit BYTES] [--threads N]: confirms how many regions a map has
// at least, as offline_mpt/COUNT.md states it. GMP only; shares no code with the solver or with what wrote
// the proof.
#include <cstdio>
#include <cstdlib>

#include "count_proof.hpp"
#include "offline_mpt/out_of_memory.hpp"

namespace {

constexpr char kUsage[] =
    "usage: check_count PROOF [--problem FILE] [--map-limit BYTES] [--threads N]\n"
    "Confirms that the active sets of PROOF, which 'offline_mpt count --proof' wrote, are critical regions "
    "with\n"
    "an interior, all different, and says how many bytes a map of them takes at the least. With --problem, "
    "the\n"
    "proof must be of that problem file; with --map-limit, the map must take more than so many bytes.\n"
    "Exit code 0: confirmed, 1: refused, 2: bad command line, or out of memory.\n";

struct Arguments {
  std::string proof, problem, map_limit, threads = "1";
};

bool isNumber(const std::string& text) {
  return text.size() <= 18 && text.find_first_not_of("0123456789") == std::string::npos;
}

void confirm(const Arguments& arguments) {
  checker::CountProof proof(arguments.proof);
  if (!arguments.problem.empty()) proof.compareProblem(checker::readFile(arguments.problem));
  const checker::Size size = proof.check(std::atoi(arguments.threads.c_str()));
  const auto number = [](std::uint64_t value) { return static_cast<unsigned long long>(value); };
  if (!arguments.map_limit.empty())
    checker::require(size.bytes > std::stoull(arguments.map_limit),
                     "the map may fit: " + std::to_string(size.bytes) + " bytes are certain, no more");
  std::printf(
      "confirmed: at least %llu regions, at least %llu bytes (%llu laws apart, %llu records in fractions)\n",
      number(size.regions), number(size.bytes), number(size.laws), number(size.exact));
}

int usage(std::FILE* stream, int code) { return std::fputs(kUsage, stream) < 0 ? 1 : code; }

}  // namespace

int main(int argc, char** argv) {
  polyfly::endInWordsWithoutMemory("check_count");
  constexpr int kMostThreads = 256;
  Arguments arguments;
  for (int k = 1; k < argc; ++k) {
    const std::string argument = argv[k];
    if (argument == "--help") return usage(stdout, 0);
    std::string* const target = argument == "--problem"     ? &arguments.problem
                                : argument == "--map-limit" ? &arguments.map_limit
                                : argument == "--threads"   ? &arguments.threads
                                                            : nullptr;
    const bool valid = target != nullptr ? ++k < argc : arguments.proof.empty() && argument[0] != '-';
    if (!valid) return usage(stderr, 2);
    (target != nullptr ? *target : arguments.proof) = argv[k];
  }
  const int threads = isNumber(arguments.threads) ? std::atoi(arguments.threads.c_str()) : 0;
  if (arguments.proof.empty() || !isNumber(arguments.map_limit) || threads < 1 || threads > kMostThreads)
    return usage(stderr, 2);
  try {
    confirm(arguments);
  } catch (const std::bad_alloc&) {  // says nothing about the proof
    polyfly::out_of_memory::end("out of memory");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "check_count: %s: refused: %s\n", arguments.proof.c_str(), error.what());
    return 1;
  }
  return 0;
}
