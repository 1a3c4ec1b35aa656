// check_count PROOF [--problem FILE] [--map-limit BYTES] [--threads N]: confirms how many regions a map has
// at least, as offline_mpt/COUNT.md states it. GMP only; shares no code with the solver or with what wrote
// the proof.
#include <cstdio>

#include "arguments.hpp"
#include "count_proof.hpp"
#include "files.hpp"
#include "polyfly_base/out_of_memory.hpp"
#include "polyfly_base/version.hpp"

namespace {

constexpr char kUsage[] =
    R"(usage: check_count PROOF [--problem FILE] [--map-limit BYTES] [--threads N]
Confirms that the active sets of PROOF are different critical regions with an interior. Prints how many bytes
their map takes at least. PROOF is from 'offline_mpt count --proof'.
With --problem, the proof must be of that problem file. With --map-limit, the map must take more bytes.
Exit codes: 0 confirmed; 1 refused; 2 the command line or a file is invalid, or memory ran out.
)";

constexpr unsigned long long kMostThreads = 256;
constexpr unsigned long long kMostBytes = 999999999999999999;

void confirm(const checker::Arguments& arguments) {
  const auto given = [&](const char* option) { return arguments.count(option) != 0; };
  const auto number = [&](const char* option, unsigned long long least, unsigned long long greatest,
                          unsigned long long otherwise) {
    return given(option) ? checker::wholeNumber(option, arguments.at(option), least, greatest) : otherwise;
  };
  const auto threads = static_cast<int>(number("--threads", 1, kMostThreads, 1));
  const unsigned long long map_limit = number("--map-limit", 0, kMostBytes, 0);
  checker::CountProof proof(arguments.at(""));
  if (given("--problem")) proof.compareProblem(checker::readFile(arguments.at("--problem")));
  const checker::Size size = proof.check(threads);
  const auto plain = [](std::uint64_t value) { return static_cast<unsigned long long>(value); };
  if (given("--map-limit"))
    checker::require(size.bytes > map_limit,
                     "the map may fit: " + std::to_string(size.bytes) + " bytes are certain, no more");
  std::printf(
      "confirmed: at least %llu regions, at least %llu bytes (%llu laws apart, %llu records in fractions)\n",
      plain(size.regions), plain(size.bytes), plain(size.laws), plain(size.exact));
}

}  // namespace

int main(int argc, char** argv) {
  polyfly::installOutOfMemoryHandler("check_count");
  return checker::run({"check_count", polyfly::kVersion, kUsage, {"--problem", "--map-limit", "--threads"}},
                      argc, argv, confirm);
}
