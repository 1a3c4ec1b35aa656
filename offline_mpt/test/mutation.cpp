#include "mutation.hpp"

#include <cstdio>
#include <sstream>
#include <utility>

#include "checksum.hpp"
#include "json_problem.hpp"
#include "robust/read_map_certificate.hpp"

namespace polyfly {
namespace {

constexpr std::size_t kMostTried = 30;  // lines of one kind

}  // namespace

std::string bytesOf(const MapContent& content) {
  const std::vector<std::byte> bytes = layOut(content);
  return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

std::string refusal(const std::string& certificate, const std::string& map, const std::string& problem) {
  return refusalOf([&] {
    const checker::Map content(map);
    const auto proof = checker::readMapCertificate(certificate, content);
    if (!problem.empty()) checker::compareProblem(*proof, content, problem);
    proof->check();
  });
}

CertifyReport proven(const ParametricProgram& program, const std::string& problem) {
  const Partition partition = explore(program);
  EXPECT_EQ(partition.status, ExploreStatus::kComplete) << program.name;
  const MapContent content = encode(program, partition);
  CertifyReport report = certified(content, program);
  EXPECT_TRUE(report.passed()) << program.name << "\n" << certifyText(report);
  EXPECT_EQ(refusal(report.certificate, bytesOf(content), problem), "") << program.name;
  return report;
}

std::string withEnd(const std::string& text) {
  return text + "end " + checker::hexText(checker::xxh64(text)) + "\n";
}

std::string sealed(std::string text, const std::string& map) {
  const std::uint64_t checksum = format::readHeader(map.data()).checksum;
  const std::string line = "\nmap " + checker::hexText(checksum) + " " + std::to_string(map.size()) + "\n";
  const std::size_t at = text.find("\nmap ");
  if (at != std::string::npos) text.replace(at, text.find('\n', at + 1) + 1 - at, line);
  return withEnd(text.substr(0, text.rfind("\nend ") + 1));
}

Words wordsOf(const std::string& line) {
  Words words;
  std::istringstream stream(line);
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

Words linesOf(const std::string& text) {
  Words lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::string joined(const Words& parts, const char* between) {
  std::string text;
  for (const std::string& part : parts) text += (text.empty() || part.empty() ? "" : between) + part;
  return text;
}

Change where(std::size_t word, const std::string& text, const Change& change) {
  return [=](Words& words) { return words.size() > word && words[word] == text && change(words); };
}

Change stepping(std::size_t word, std::size_t by, std::size_t count) {
  return [=](Words& words) {
    words[word] = std::to_string((std::stoul(words[word]) + by) % count);
    return true;
  };
}

Change setting(std::size_t word, const std::string& text) {
  return [=](Words& words) {
    words[word] = text;
    return true;
  };
}

Change replacing(const Words& replacement) {
  return [=](Words& words) {
    words = replacement;
    return true;
  };
}

Change leavingOut() { return replacing({}); }

Change repeating() {
  return [](Words& words) {
    const std::string line = joined(words, " ");
    words.back() += "\n" + line;
    return true;
  };
}

Change negatingLast() {
  return [](Words& words) {
    words.back() = "-" + words.back();
    return true;
  };
}

Change lengtheningLast(const std::string& text) {
  return [=](Words& words) {
    words.back() += text;
    return true;
  };
}

Change droppingLast() {
  return [](Words& words) {
    words.pop_back();
    return true;
  };
}

Subject::Subject(ParametricProgram made) : program(std::move(made)), content(solved(program)) {
  const CertifyReport report = certified(content, program);
  EXPECT_TRUE(report.passed()) << certifyText(report);
  certificate = report.certificate;
}

Subject::Subject(MapContent map, std::string proof)
    : content(std::move(map)), certificate(std::move(proof)) {}

Mutation::Mutation(const Subject& subject)
    : program_(subject.program),
      content_(subject.content),
      map_(bytesOf(content_)),
      certificate_(subject.certificate) {}

std::string Mutation::refusalOfMap(const MapContent& content) const {
  const std::string map = bytesOf(content);
  return refusal(sealed(certificate_, map), map);
}

std::string Mutation::refusalOfLines(const Words& lines) const {
  return refusal(sealed(joined(lines, "\n") + "\n", map_), map_);
}

void Mutation::expectRefused(const std::string& key, const Change& change, int least,
                             const std::string& part) const {
  Words lines = linesOf(certificate_);
  std::vector<std::pair<std::size_t, std::string>> changes;  // line, its new text
  for (std::size_t k = 0; k < lines.size(); ++k) {
    if (lines[k].compare(0, key.size() + 1, key + " ") != 0) continue;
    Words words = wordsOf(lines[k]);
    if (change(words)) changes.emplace_back(k, joined(words, " "));
  }
  int tried = 0;
  const std::size_t stride = 1 + changes.size() / kMostTried;
  for (std::size_t k = 0; k < changes.size(); k += stride) {
    auto& [at, text] = changes[k];
    std::swap(lines[at], text);
    ++tried;
    const std::string reason = refusalOfLines(lines);
    EXPECT_NE(reason, "") << lines[at] << " instead of " << text;
    EXPECT_TRUE(holds(reason, part)) << lines[at] << " instead of " << text;
    std::swap(lines[at], text);
  }
  EXPECT_GE(tried, least) << key;
}

}  // namespace polyfly
