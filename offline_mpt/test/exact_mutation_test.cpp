// The checker confirms what is right and refuses everything that was changed.
#include <gtest/gtest.h>

#include <cctype>
#include <cstdio>
#include <sstream>

#include "certificate.hpp"
#include "exact_programs.hpp"
#include "map_in_memory.hpp"
#include "offline_mpt/certify.hpp"
#include "offline_mpt/encode.hpp"
#include "offline_mpt/explore.hpp"
#include "region_maps/error.hpp"

namespace polyfly {
namespace {

constexpr std::size_t kMostTried = 30;  // lines of one kind

std::string bytesOf(const MapContent& content) {
  const std::vector<std::byte> bytes = layOut(content);
  return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

/// Empty where the certificate is confirmed, else why not.
std::string refusal(const std::string& certificate, const std::string& map, const std::string& problem = "") {
  try {
    const checker::Map content(map);
    const checker::Certificate proof(certificate, content);
    if (!problem.empty()) proof.compareProblem(problem);
    proof.check();
  } catch (const checker::Refused& error) {
    return error.what();
  }
  return "";
}

/// Gives a changed certificate the checksum of its new text, and names the map that it comes with.
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

std::vector<std::string> wordsOf(const std::string& line) {
  std::vector<std::string> words;
  std::istringstream stream(line);
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

class Mutation : public ::testing::Test {
 protected:
  explicit Mutation(ParametricProgram program = doubleIntegrator(3)) : program_(std::move(program)) {
    content_ = encode(program_, explore(program_));
    map_ = bytesOf(content_);
    const CertifyReport report = certify(MapInMemory(content_).map(), program_);
    EXPECT_TRUE(report.passed()) << certifyText(report);
    certificate_ = report.certificate;
  }

  /// Why a changed map is refused with the certificate of the right one.
  std::string refusalOfMap(const MapContent& content) const {
    const std::string map = bytesOf(content);
    return refusal(sealed(certificate_, map), map);
  }

  /// Why the certificate is refused after `change` of each line that starts with `key`, one at a time. Empty
  /// where one of them is confirmed. Of many lines some all over the certificate are taken; `tried` counts
  /// them.
  template <typename Change>
  std::string refusalOfLines(const std::string& key, Change change, int& tried) const {
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

  ParametricProgram program_;
  MapContent content_;
  std::string map_;
  std::string certificate_;
};

TEST_F(Mutation, NothingChangedIsConfirmed) {
  EXPECT_EQ(refusal(certificate_, map_), "");
  EXPECT_EQ(refusal(sealed(certificate_, map_), map_), "");
}

TEST_F(Mutation, AnyByteOfTheCertificateIsCaught) {
  for (std::size_t at = 0; at<certificate_.size(); at += certificate_.size()> 4000 ? 7 : 1) {
    std::string changed = certificate_;
    changed[at] ^= static_cast<char>(1 + at % 7);
    EXPECT_NE(refusal(changed, map_), "") << at;
  }
}

TEST_F(Mutation, ACertificateThatWasCutOffIsCaught) {
  for (std::size_t size = 0; size < certificate_.size(); size += 97)
    EXPECT_NE(refusal(certificate_.substr(0, size), map_), "") << size;
}

TEST_F(Mutation, AnyByteOfTheMapIsCaught) {
  for (std::size_t at = 0; at < map_.size(); at += 11) {
    std::string changed = map_;
    changed[at] ^= static_cast<char>(1 + at % 7);
    EXPECT_NE(refusal(certificate_, changed), "") << at;
  }
}

// From here on all checksums are right: the proof itself must fail.

TEST_F(Mutation, EveryLawEntryIsChecked) {
  for (std::size_t k = 0; k < content_.laws.size(); ++k) {
    MapContent changed = content_;
    changed.laws[k] += 1e-6 * (1.0 + std::abs(changed.laws[k]));
    EXPECT_NE(refusalOfMap(changed).find("law"), std::string::npos) << k;
  }
}

TEST_F(Mutation, EveryPlaneEntryIsChecked) {
  for (std::size_t k = 0; k < content_.planes.size(); ++k) {
    MapContent changed = content_;
    changed.planes[k] += 1e-6;
    EXPECT_NE(refusalOfMap(changed).find("plane"), std::string::npos) << k;
  }
}

TEST_F(Mutation, EveryRowIsChecked) {
  for (std::size_t k = 0; k < content_.rows.size(); ++k) {
    MapContent changed = content_;
    changed.rows[k] = -changed.rows[k];
    EXPECT_NE(refusalOfMap(changed), "") << k;
    const auto planes = static_cast<std::int32_t>(content_.planes.size() / 3);
    changed.rows[k] =
        content_.rows[k] > 0 ? content_.rows[k] % planes + 1 : -(-content_.rows[k] % planes + 1);
    EXPECT_NE(refusalOfMap(changed), "") << k;
  }
}

TEST_F(Mutation, EveryActiveRowIsChecked) {
  const int rows = program_.rowCount();
  for (std::size_t k = 0; k < content_.active.size(); ++k) {
    for (const int wrong : {(content_.active[k] + 1) % rows, (content_.active[k] + 5) % rows, rows}) {
      MapContent changed = content_;
      changed.active[k] = wrong;
      EXPECT_NE(refusalOfMap(changed), "") << k << " " << wrong;
    }
  }
}

TEST_F(Mutation, ADroppedRegionIsCaught) {
  MapContent changed = content_;
  changed.regions.pop_back();
  changed.nodes.clear();
  changed.leaves = {{0, 1}};
  changed.root = MapContent::kLeaf;
  changed.candidates = {0};
  EXPECT_NE(refusalOfMap(changed), "");
  // Also where the certificate agrees that it never existed: a facet then has no region behind it.
  std::string shorter = certificate_;
  const std::size_t last = shorter.rfind("\nR ");
  shorter.erase(last + 1, shorter.rfind("\nend ") - last);
  const std::size_t count = shorter.find("\nregions ") + 9;
  shorter.replace(count, shorter.find('\n', count) - count, std::to_string(changed.regions.size()));
  const std::string map = bytesOf(changed);
  EXPECT_NE(refusal(sealed(shorter, map), map), "");
}

TEST_F(Mutation, ARemovedFacetIsCaught) {
  for (std::size_t r = 0; r < content_.regions.size(); ++r) {
    MapContent changed = content_;
    changed.regions[r].row_count -= 1;
    EXPECT_NE(refusalOfMap(changed), "") << r;
  }
  int tried = 0;
  std::vector<std::string> lines = linesOf(certificate_);
  for (std::size_t k = 0; k < lines.size(); ++k) {
    if (lines[k].compare(0, 2, "L ") != 0 || k % 3 != 0) continue;
    std::vector<std::string> fewer = lines;
    fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(k));
    EXPECT_NE(refusal(sealed(joined(fewer, "\n") + "\n", map_), map_), "") << lines[k];
    ++tried;
  }
  EXPECT_GT(tried, 10);
}

TEST_F(Mutation, ANeighbourIsChecked) {
  int tried = 0;
  const std::size_t count = content_.regions.size();
  EXPECT_NE(refusalOfLines(
                "L ",
                [&](std::vector<std::string>& words) {
                  if (words[3] != "next") return false;
                  words[5] = std::to_string((std::stoul(words[5]) + 1) % count);
                  return true;
                },
                tried),
            "");
  EXPECT_GT(tried, 10);
}

TEST_F(Mutation, AnOriginIsChecked) {
  int tried = 0;
  EXPECT_NE(refusalOfLines(
                "L ",
                [&](std::vector<std::string>& words) {
                  const int row = std::stoi(words[2].substr(1));
                  words[2] = words[2][0] + std::to_string(words[2][0] == 'b' ? row ^ 1 : row + 1);
                  return true;
                },
                tried),
            "");
  EXPECT_GT(tried, 20);
}

TEST_F(Mutation, AnInnerFacetIsNoEdgeOfTheDomain) {
  int tried = 0;
  EXPECT_NE(refusalOfLines(
                "L ",
                [&](std::vector<std::string>& words) {
                  if (words[3] == "domain") return false;
                  words.resize(5);
                  words[3] = "domain";
                  words[4] = words[2];
                  return true;
                },
                tried),
            "");
  EXPECT_GT(tried, 10);
}

TEST_F(Mutation, WeightsOfAnEdgeAreChecked) {
  for (const bool negate : {true, false}) {
    int tried = 0;
    EXPECT_NE(refusalOfLines(
                  "L ",
                  [&](std::vector<std::string>& words) {
                    if (words[3] != "edge") return false;
                    words.back() = negate ? "-" + words.back() : words.back() + "0";
                    return words.size() > 7;  // one row alone may have any positive weight
                  },
                  tried),
              "");
    EXPECT_GT(tried, 0);
  }
}

TEST_F(Mutation, FarkasMultipliersAreChecked) {
  const auto negate = [](std::vector<std::string>& words) {
    words.back() = "-" + words.back();
    return true;
  };
  const auto enlarge = [](std::vector<std::string>& words) {
    words.back() += "000";
    return true;
  };
  const auto remove = [](std::vector<std::string>& words) {
    words[3] = "0";
    words.resize(4);
    return true;
  };
  const auto misplace = [](std::vector<std::string>& words) {
    words[4] = "99";
    return true;
  };
  const auto unscale = [](std::vector<std::string>& words) {
    words[2] = "0";
    return true;
  };
  int tried = 0;
  EXPECT_NE(refusalOfLines("I ", negate, tried), "");
  EXPECT_GT(tried, 20);
  EXPECT_NE(refusalOfLines("I ", enlarge, tried), "");
  EXPECT_NE(refusalOfLines("I ", remove, tried), "");
  EXPECT_NE(refusalOfLines("I ", misplace, tried), "");
  EXPECT_NE(refusalOfLines("I ", unscale, tried), "");
}

TEST_F(Mutation, AnInnerPointIsChecked) {
  int tried = 0;
  EXPECT_NE(refusalOfLines(
                "P ",
                [](std::vector<std::string>& words) {
                  words[1] = "2";
                  return true;
                },
                tried),
            "");
  EXPECT_EQ(tried, static_cast<int>(content_.regions.size()));
}

TEST_F(Mutation, TheProgramIsChecked) {
  for (const char* key : {"H ", "F ", "A ", "b ", "S ", "E ", "C ", "c ", "box "}) {
    int tried = 0;
    EXPECT_NE(refusalOfLines(
                  key,
                  [](std::vector<std::string>& words) {
                    words[3] = words[3] == "0x1p+0" ? "0x1.8p+0" : "0x1p+0";
                    return true;
                  },
                  tried),
              "")
        << key;
    EXPECT_EQ(tried, 1);
  }
}

TEST_F(Mutation, AnIndefiniteHessianIsCaught) {
  int tried = 0;
  EXPECT_NE(refusalOfLines(
                "H ",
                [](std::vector<std::string>& words) {
                  words[3] = "-" + words[3];
                  return true;
                },
                tried)
                .find("semidefinite"),
            std::string::npos);
}

TEST_F(Mutation, AnotherMapIsCaught) {
  MapContent other = content_;
  other.name = "another";
  EXPECT_NE(refusal(certificate_, bytesOf(other)).find("another map"), std::string::npos);
}

/// A facet that several regions share: its cover is checked piece by piece.
class CoverMutation : public Mutation {
 protected:
  CoverMutation() : Mutation(smallLinearProgram()) {}
};

TEST_F(CoverMutation, NothingChangedIsConfirmed) {
  EXPECT_EQ(refusal(certificate_, map_), "");
  EXPECT_NE(certificate_.find(" cover N "), std::string::npos);
}

TEST_F(CoverMutation, CoversAreChecked) {
  const std::size_t count = content_.regions.size();
  int tried = 0;
  const auto isCover = [](const std::vector<std::string>& words) {
    return words.size() > 5 && words[3] == "cover";
  };
  EXPECT_NE(refusalOfLines(
                "L ",
                [&](std::vector<std::string>& words) {
                  if (!isCover(words) || words[4] != "N") return false;
                  words[5] = std::to_string((std::stoul(words[5]) + 1) % count);
                  return true;
                },
                tried),
            "");
  EXPECT_GT(tried, 0);
  EXPECT_NE(refusalOfLines(
                "L ",
                [&](std::vector<std::string>& words) {
                  if (!isCover(words)) return false;
                  words.pop_back();
                  return true;
                },
                tried),
            "");
  EXPECT_NE(refusalOfLines(
                "L ",
                [&](std::vector<std::string>& words) {
                  if (!isCover(words)) return false;
                  words = {words[0], words[1], words[2], "cover",
                           "e",      "1",      "0",      "1"};  // "there is no such facet"
                  return true;
                },
                tried),
            "");
}

/// A map that leaves slivers to the regions about them.
class SliverMutation : public Mutation {
 protected:
  SliverMutation() : Mutation(nearlyDependent(1e-5, 3)) {}
};

TEST_F(SliverMutation, NothingChangedIsConfirmed) {
  EXPECT_EQ(refusal(certificate_, map_), "");
  EXPECT_NE(certificate_.find("\nG "), std::string::npos);
  EXPECT_NE(certificate_.find("\nV N "), std::string::npos);
}

TEST_F(SliverMutation, ASliverIsDescribedByItsActiveSet) {
  int tried = 0;
  EXPECT_NE(refusalOfLines(
                "G ",
                [](std::vector<std::string>& words) {
                  words[1] = std::to_string(words.size() - 3);
                  words.pop_back();
                  return true;
                },
                tried),
            "");
  EXPECT_NE(refusalOfLines(
                "G ",
                [](std::vector<std::string>& words) {
                  words.back() = "12";
                  return true;
                },
                tried),
            "");
  EXPECT_GT(tried, 0);
}

TEST_F(SliverMutation, ASliverMustLieInRegionsOfTheMap) {
  int tried = 0;
  const std::size_t count = content_.regions.size();
  EXPECT_NE(refusalOfLines(
                "V ",
                [](std::vector<std::string>& words) {
                  words = {"V", "e", "1", "0", "1"};  // "there is no such sliver"
                  return true;
                },
                tried),
            "");
  EXPECT_NE(refusalOfLines(
                "V ",
                [&](std::vector<std::string>& words) {
                  words[2] = std::to_string(count);  // a sliver
                  return true;
                },
                tried),
            "");
  EXPECT_NE(refusalOfLines(
                "V ",
                [&](std::vector<std::string>& words) {
                  words[2] = std::to_string((std::stoul(words[2]) + count / 2) % count);
                  return true;
                },
                tried),
            "");
  EXPECT_GT(tried, 0);
}

TEST_F(SliverMutation, ATighterToleranceIsRefused) {
  int tried = 0;
  EXPECT_NE(refusalOfLines(
                "tolerances ",
                [](std::vector<std::string>& words) {
                  words[2] = "0x1p-60";
                  return true;
                },
                tried),
            "");
}

TEST_F(SliverMutation, NoSliverMayBeMissing) {
  const std::size_t first = certificate_.find("\nG ");
  std::string without = certificate_;
  without.erase(first + 1, without.rfind("\nend ") - first);
  EXPECT_NE(refusal(sealed(without, map_), map_), "");
}

/// A map whose program counts with a row that is relaxed.
class RelaxedMutation : public Mutation {
 protected:
  RelaxedMutation() : Mutation(touching(1)) {}
};

TEST_F(RelaxedMutation, RelaxedRowsAreCountedAsSuch) {
  EXPECT_EQ(refusal(certificate_, map_), "");
  if (certificate_.find("\nrelaxed 0\n") != std::string::npos)
    GTEST_SKIP() << "rounding left nothing to relax";
  int tried = 0;
  EXPECT_NE(refusalOfLines(
                "relaxed ",
                [](std::vector<std::string>& words) {
                  words = {"relaxed", "0"};
                  return true;
                },
                tried),
            "");
  EXPECT_EQ(tried, 1);
}

/// Certificates small enough to try every bit.
class BitMutation : public Mutation {
 protected:
  BitMutation() : Mutation(randomProgram(2, 8, 1, 1)) {}

  /// A wrong map, with whatever checksum the certificate then needs, is never confirmed.
  void expectNeverConfirmed(const MapContent& wrong) const {
    const std::string map = bytesOf(wrong);
    ASSERT_NE(refusal(sealed(certificate_, map), map), "");
    const std::size_t first = certificate_.find("\ntolerances ");
    for (std::size_t at = certificate_.find("\nregions "); at < certificate_.rfind("\nend "); ++at) {
      if (at <= first || std::isxdigit(static_cast<unsigned char>(certificate_[at])) == 0) continue;
      for (int bit = 0; bit < 8; ++bit) {
        std::string changed = certificate_;
        changed[at] = static_cast<char>(changed[at] ^ (1 << bit));
        EXPECT_NE(refusal(sealed(changed, map), map), "") << at << " " << bit;
      }
    }
  }
};

TEST_F(BitMutation, EveryBitOfTheCertificateIsCaught) {
  for (std::size_t at = 0; at < certificate_.size(); ++at) {
    for (int bit = 0; bit < 8; ++bit) {
      std::string changed = certificate_;
      changed[at] = static_cast<char>(changed[at] ^ (1 << bit));
      EXPECT_NE(refusal(changed, map_), "") << at << " " << bit;
    }
  }
}

TEST_F(BitMutation, NoBitOfTheCertificateMakesAWrongLawRight) {
  MapContent wrong = content_;
  wrong.laws[0] += 1e-6;
  expectNeverConfirmed(wrong);
}

TEST_F(BitMutation, NoBitOfTheCertificateMakesAWrongPlaneRight) {
  MapContent wrong = content_;
  wrong.planes[1] += 1e-6;
  expectNeverConfirmed(wrong);
}

TEST(CheckerInput, Xxh64KnownValues) {
  EXPECT_EQ(checker::xxh64(""), 0xef46db3751d8e999ull);
  EXPECT_EQ(checker::xxh64("abc"), 0x44bc2cf5ad770999ull);
}

TEST(CheckerInput, JsonNumbersOfAKey) {
  const std::string text =
      R"({"a": [[1, -2.5], [3e2, 4]], "s": "\"b\": [7]", "n": {"b": 8}, "b": [9], "x": 5})";
  EXPECT_EQ(checker::jsonNumbers(text, "a"), (std::vector<double>{1, -2.5, 300, 4}));
  EXPECT_EQ(checker::jsonNumbers(text, "b"), (std::vector<double>{9}));
  EXPECT_EQ(checker::jsonNumbers(text, "none"), (std::vector<double>{}));
}

constexpr char kJsonProblem[] = R"({
  "H": [[1.5064, 0.4838], [0.4838, 1.5258]], "f": [0, 0],
  "F": [[9.6652, 5.2115], [7.0732, -7.0879]],
  "A": [[1, 0], [-1, 0], [0, 1], [0, -1]], "b": [2, 2, 2, 2],
  "B": [[0, 0], [0, 0], [0, 0], [0, 0]], "eq_ids": [], "lb": [-1.5, -1.5], "ub": [1.5, 1.5], "out": [0]
})";

TEST(CheckerInput, AJsonProblemIsComparedNumberByNumber) {
  const ParametricProgram program = parseProgramJson(kJsonProblem, "test.json");
  const MapContent content = encode(program, explore(program));
  const CertifyReport report = certify(MapInMemory(content).map(), program);
  const std::string map = bytesOf(content);
  EXPECT_EQ(refusal(report.certificate, map, kJsonProblem), "");
  std::string other = kJsonProblem;
  other.replace(other.find("1.5064"), 6, "1.5065");
  EXPECT_NE(refusal(report.certificate, map, other), "");
  // The map and the certificate carry the other text, but the numbers of the first.
  MapContent relabelled = content;
  relabelled.problem_text = other;
  EXPECT_THROW(certify(MapInMemory(relabelled).map(), program), Error);
  ParametricProgram liar = program;
  liar.text = other;
  const CertifyReport forged = certify(MapInMemory(relabelled).map(), liar);
  ASSERT_TRUE(forged.passed());
  EXPECT_NE(refusal(forged.certificate, bytesOf(relabelled), other).find("H is not"), std::string::npos);
}

}  // namespace
}  // namespace polyfly
