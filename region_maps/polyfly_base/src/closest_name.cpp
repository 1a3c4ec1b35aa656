#include "polyfly_base/closest_name.hpp"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <numeric>

namespace polyfly {
namespace {

constexpr std::size_t kLongName = 6;  // letters

std::string lowered(std::string text) {
  for (char& letter : text) letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  return text;
}

/// Least number of letters to be replaced, put in or left out (Levenshtein).
std::size_t distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

}  // namespace

std::optional<std::string> closestName(const std::string& name, const std::vector<std::string>& known) {
  if (std::find(known.begin(), known.end(), name) != known.end()) return std::nullopt;
  const std::string plain = lowered(name);
  std::optional<std::string> meant;
  std::size_t least = (name.size() >= kLongName ? 2 : 1) + 1;
  for (const std::string& candidate : known) {
    const std::size_t letters = distance(plain, lowered(candidate));
    if (letters >= least) continue;
    least = letters;
    meant = candidate;
  }
  return meant;
}

}  // namespace polyfly
