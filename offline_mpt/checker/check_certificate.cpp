// check_certificate CERTIFICATE --map MAP [--problem FILE]: confirms a certificate by substitution, as
// offline_mpt/CERTIFICATE.md states it. With --export, it proves the bounds of exported C code again. GMP only; shares
// no code with the solver or with what wrote certificate and code.
#include <cstdio>
#include <filesystem>
#include <system_error>

#include "arguments.hpp"
#include "export_bound.hpp"
#include "files.hpp"
#include "json_problem.hpp"
#include "polyfly_base/out_of_memory.hpp"
#include "polyfly_base/version.hpp"
#include "reduction.hpp"
#include "robust/read_map_certificate.hpp"

namespace {

constexpr char kUsage[] =
    R"(usage: check_certificate CERTIFICATE --map MAP [--problem FILE] [--time-limit SECONDS]
       check_certificate CERTIFICATE --map REDUCED --reduced-from ORIGINAL
       check_certificate --export DIR --map MAP
Confirms in rational arithmetic that MAP is the complete solution of its problem. The certificate is from
'offline_mpt verify --exact'. With --problem, the certificate must be of that problem file.
With --reduced-from, it confirms that REDUCED answers as ORIGINAL does. The certificate is then from
'offline_mpt verify --reduced-from'. ORIGINAL has a certificate of its own.
With --export, it confirms the bounds that the only .json file of DIR states of the .c and .h files of the same
name, from 'offline_mpt export': their tables, and all text around these. MAP has a certificate of its own.
Exit codes: 0 confirmed; 1 refused; 2 the command line or a file is invalid, or memory ran out; 3 stopped at the time limit.
)";

constexpr char kCompared[] = "the program's numbers are those of the problem that the map carries\n";
constexpr char kNotCompared[] = "not confirmed here: that this program is the problem that the map carries\n";

std::string valueOf(const checker::Arguments& arguments, const std::string& option) {
  const auto found = arguments.find(option);
  return found == arguments.end() ? "" : found->second;
}

/// The only file of the folder that ends so, without its ending.
std::string onlyStem(const std::string& folder, const std::string& ending) {
  std::string stem;
  std::error_code failure;
  for (const auto& entry : std::filesystem::directory_iterator(folder, failure)) {
    if (entry.path().extension() != ending) continue;
    if (!stem.empty()) throw checker::Unreadable(folder + ": has more than one file *" + ending);
    stem = (entry.path().parent_path() / entry.path().stem()).string();
  }
  if (stem.empty()) throw checker::Unreadable(folder + ": has no file *" + ending);
  return stem;
}

checker::Map readMap(const std::string& path) {
  return checker::withFile(path, [](const std::string& bytes) { return checker::Map(bytes); });
}

void confirmCode(const std::string& folder, const std::string& map_file) {
  using checker::readFile;
  const std::string stem = onlyStem(folder, ".json");
  const checker::Map map = readMap(map_file);
  checker::confirmExport(readFile(stem + ".json"), readFile(stem + ".c"), readFile(stem + ".h"), map);
  std::printf("confirmed: the code of %zu regions answers within its bounds\n", map.regions.size());
}

void confirm(const checker::Arguments& arguments) {
  using checker::readFile;
  const std::string certificate = valueOf(arguments, ""), map_file = valueOf(arguments, "--map"),
                    problem = valueOf(arguments, "--problem"),
                    original_file = valueOf(arguments, "--reduced-from");
  if (map_file.empty()) throw checker::BadUsage("--map is missing");
  if (const std::string folder = valueOf(arguments, "--export"); !folder.empty()) {
    if (!problem.empty() || !original_file.empty()) throw checker::BadUsage("--export takes --map alone");
    confirmCode(folder, map_file);
    return;
  }
  if (!problem.empty() && !original_file.empty())
    throw checker::BadUsage("--problem and --reduced-from exclude each other");
  const checker::Map map = readMap(map_file);
  std::string conditions;
  if (original_file.empty()) {
    const auto proof = checker::readMapCertificate(readFile(certificate), map);
    const bool is_compared = !map.problem.empty() && map.kind() == "json";
    if (is_compared) checker::compareProblem(*proof, map, map.problem);
    if (!problem.empty())
      checker::withFile(problem,
                        [&](const std::string& text) { checker::compareProblem(*proof, map, text); });
    proof->progress = checker::showProgress;
    proof->check();
    conditions = proof->conditions() + (is_compared ? kCompared : kNotCompared);
  } else {
    const checker::Map original = readMap(original_file);
    checker::Reduction proof(readFile(certificate), map, original);
    proof.check();
    conditions = proof.conditions();
  }
  std::printf("confirmed: %zu regions\n%s", map.regions.size(), conditions.c_str());
}

}  // namespace

int main(int argc, char** argv) {
  polyfly::installOutOfMemoryHandler("check_certificate");
  return checker::run({"check_certificate",
                       polyfly::kVersion,
                       kUsage,
                       {"--map", "--problem", "--reduced-from", "--export"},
                       "--export"},
                      argc, argv, confirm);
}
