#include "mutation.hpp"

#include <cstdio>
#include <sstream>
#include <utility>

#include "checksum.hpp"
#include "json_problem.hpp"
#include "map_in_memory.hpp"
#include "offline_mpt/certify.hpp"
#include "offline_mpt/encode.hpp"
#include "offline_mpt/explore.hpp"
#include "robust/read_map_certificate.hpp"

namespace polyfly {
namespace {

constexpr std::size_t kMostTried = 30;  // lines of one kind

std::vector<std::string> wordsOf(const std::string& line) {
  std::vector<std::string> words;
  std::istringstream stream(line);
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

}  // namespace

std::string bytesOf(const MapContent& content) {
  const std::vector<std::byte> bytes = layOut(content);
  return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

std::string refusal(const std::string& certificate, const std::string& map, const std::string& problem) {
  try {
    const checker::Map content(map);
    const auto proof = checker::readMapCertificate(certificate, content);
    if (!problem.empty()) checker::compareProblem(*proof, content, problem);
    proof->check();
  } catch (const checker::Refused& error) {
    return error.what();
  }
  return "";
}

std::string sealed(std::string text, const std::string& map) {
  const checker::Map content(map);
  char line[64];
  std::snprintf(line, sizeof line, "\nmap %016llx %zu\n", static_cast<unsigned long long>(content.checksum),
                map.size());
  const std::size_t at = text.find("\nmap ");
  text.replace(at, text.find('\n', at + 1) + 1 - at, line);
  text.erase(text.rfind("\nend ") + 1);
  std::snprintf(line, sizeof line, "end %016llx\n", static_cast<unsigned long long>(checker::xxh64(text)));
  return text + line;
}

std::vector<std::string> linesOf(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::string joined(const std::vector<std::string>& parts, const char* between) {
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : between) + part;
  return text;
}

Change setting(std::size_t word, const std::string& text) {
  return [=](std::vector<std::string>& words) {
    words[word] = text;
    return true;
  };
}

Change replacing(const std::vector<std::string>& replacement) {
  return [=](std::vector<std::string>& words) {
    words = replacement;
    return true;
  };
}

Mutation::Mutation(ParametricProgram program) : program_(std::move(program)) {
  content_ = encode(program_, explore(program_));
  map_ = bytesOf(content_);
  const CertifyReport report = certify(MapInMemory(content_).map(), program_);
  EXPECT_TRUE(report.passed()) << certifyText(report);
  certificate_ = report.certificate;
}

Mutation::Mutation(MapContent content, std::string certificate)
    : content_(std::move(content)), map_(bytesOf(content_)), certificate_(std::move(certificate)) {}

std::string Mutation::refusalOfMap(const MapContent& content) const {
  const std::string map = bytesOf(content);
  return refusal(sealed(certificate_, map), map);
}

std::string Mutation::refusalOfLines(const std::string& key, const Change& change, int& tried) const {
  std::vector<std::string> lines = linesOf(certificate_);
  std::vector<std::pair<std::size_t, std::string>> changes;  // line, its new text
  for (std::size_t k = 0; k < lines.size(); ++k) {
    if (lines[k].compare(0, key.size(), key) != 0) continue;
    std::vector<std::string> words = wordsOf(lines[k]);
    if (change(words)) changes.emplace_back(k, joined(words, " "));
  }
  std::string last = "nothing was tried";
  tried = 0;
  const std::size_t stride = 1 + changes.size() / kMostTried;
  for (std::size_t k = 0; k < changes.size(); k += stride) {
    auto& [at, text] = changes[k];
    std::swap(lines[at], text);
    ++tried;
    last = refusal(sealed(joined(lines, "\n") + "\n", map_), map_);
    if (last.empty()) {
      ADD_FAILURE() << "confirmed: " << lines[at] << " instead of " << text;
      return last;
    }
    std::swap(lines[at], text);
  }
  return last;
}

}  // namespace polyfly
