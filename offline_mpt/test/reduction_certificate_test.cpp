// Certificates of reductions: the checker confirms right ones, and no proof of a wrong map.
#include <algorithm>

#include "checksum.hpp"
#include "error_of.hpp"
#include "grid_map.hpp"
#include "mutation.hpp"
#include "offline_mpt/reduce.hpp"
#include "offline_mpt/verify_reduction.hpp"
#include "reduction.hpp"
#include "reduction_mutation.hpp"

namespace polyfly {
namespace {

/// The certificate as if it were of another reduced map.
std::string forged(const std::string& certificate, const std::string& reduced) {
  Words lines = linesOf(certificate);
  lines[1] =
      "reduced " + checker::hexText(checker::Map(reduced).checksum) + " " + std::to_string(reduced.size());
  lines.pop_back();
  return withEnd(joined(lines, "\n") + "\n");
}

/// The proof of a reduction, with its certificate.
ReductionReport proofOf(const RegionMap& reduced, const RegionMap& original, int threads = 1) {
  ReductionOptions options;
  options.certificate = true;
  options.threads = threads;
  return verifyReduction(reduced, original, options);
}

MapContent reducedToASmallTree(const RegionMap& original) {
  ReduceOptions options;
  options.tree = TreeMode::kSmall;
  return reduce(original, options).content;
}

class ReductionCertificate : public ::testing::Test {
 protected:
  ReductionCertificate() : original_(gridMap(8, 3, cellsOf({"UUbL....", "UbcL....", "bcLL...."}))) {
    content_ = reducedToASmallTree(original_.map());
    const MapInMemory reduced(content_);
    reduced_ = reduced.bytes();
    certificate_ = proofOf(reduced.map(), original_.map()).certificate;
  }

  std::string refusalOf(const std::string& certificate) const {
    return reductionRefusal(certificate, reduced_, original_.bytes());
  }

  /// The refusal after one word of a line is replaced.
  std::string refusalWith(std::size_t line, std::size_t word, const std::string& text) const {
    Words lines = linesOf(certificate_);
    lines.pop_back();
    Words words = wordsOf(lines[line]);
    words.at(word) = text;
    lines[line] = joined(words, " ");
    return refusalOf(withEnd(joined(lines, "\n") + "\n"));
  }

  MapInMemory original_;
  MapContent content_;
  std::string reduced_, certificate_;
};

TEST_F(ReductionCertificate, IsConfirmedAndTheSameForAnyNumberOfThreads) {
  ASSERT_NE(certificate_, "");
  EXPECT_EQ(refusalOf(certificate_), "");
  EXPECT_EQ(proofOf(MapInMemory(content_).map(), original_.map(), 3).certificate, certificate_);
}

TEST_F(ReductionCertificate, IsNoProofOfAWrongMap) {
  for (const auto& [what, changed] : wrongMaps(content_)) {
    const std::string bytes = MapInMemory(changed).bytes();
    EXPECT_NE(reductionRefusal(certificate_, bytes, original_.bytes()), "") << what;
    EXPECT_NE(reductionRefusal(forged(certificate_, bytes), bytes, original_.bytes()), "") << what;
  }
}

TEST_F(ReductionCertificate, EveryWordCounts) {
  const Words lines = linesOf(certificate_);
  std::size_t confirmed = 0, tried = 0;
  for (std::size_t line = 4; line + 1 < lines.size(); ++line) {
    const Words words = wordsOf(lines[line]);
    for (std::size_t word = 0; word < words.size(); ++word) {
      const std::string& text = words[word];
      const bool is_step = text.find_first_of("NCBnsweq") != std::string::npos && text.size() == 1;
      if (word >= 2 && !is_step) continue;
      for (const char* other : {"N", "C", "O", "B", "n", "s", "w", "q", "0", "99"}) {
        if (text == other) continue;
        ++tried;
        confirmed += refusalWith(line, word, other).empty() ? 1 : 0;
      }
    }
  }
  EXPECT_GT(tried, 500u);
  EXPECT_EQ(confirmed, 0u) << "of " << tried;
}

TEST_F(ReductionCertificate, WeightsMustProveWhatTheyAreFor) {
  const Words lines = linesOf(certificate_);
  std::size_t tried = 0;
  for (std::size_t line = 4; line + 1 < lines.size(); ++line) {
    const Words words = wordsOf(lines[line]);
    for (std::size_t k = 2; k + 3 < words.size(); ++k) {
      if (words[k] != "e" || words[k + 1] == "0") continue;
      ++tried;
      EXPECT_NE(refusalWith(line, k + 3, "-1"), "") << lines[line];
      EXPECT_NE(refusalWith(line, k + 2, "999"), "") << lines[line];
      EXPECT_NE(refusalWith(line, k + 1, "0"), "") << lines[line];
    }
  }
  EXPECT_GT(tried, 20u);
}

TEST(ReductionCertificateOfAController, RowsThatAreNotTestedHaveProofs) {
  const MapInMemory original(solved(doubleIntegrator(5)));
  const MapInMemory reduced(reducedToASmallTree(original.map()));
  const std::string certificate = proofOf(reduced.map(), original.map()).certificate;
  EXPECT_EQ(reductionRefusal(certificate, reduced.bytes(), original.bytes()), "");
  Words lines = linesOf(certificate);
  lines.pop_back();
  const auto is_drop = [](const std::string& line) { return line.rfind("drop ", 0) == 0; };
  const auto first = std::remove_if(lines.begin(), lines.end(), is_drop);
  EXPECT_GT(lines.end() - first, 3);
  lines.erase(first, lines.end());
  EXPECT_TRUE(holds(reductionRefusal(withEnd(joined(lines, "\n") + "\n"), reduced.bytes(), original.bytes()),
                    "is not tested"));
}

TEST_F(ReductionCertificate, TolerancesHaveLimits) {
  EXPECT_NE(refusalWith(3, 2, "0x1p-3"), "");
  EXPECT_NE(refusalWith(3, 2, "-0x1p-40"), "");
  EXPECT_NE(refusalWith(3, 1, "-0x1p-40"), "");
  EXPECT_NE(refusalWith(3, 1, "0x1p0"), "");  // any law would do
  EXPECT_NE(refusalWith(3, 0, "tolerance"), "");
}

// Without a limit such a line uses up the stack.
TEST_F(ReductionCertificate, NestedCutsHaveALimit) {
  const Words lines = linesOf(certificate_);
  std::size_t line = 4;
  while (lines[line].rfind("R 0 ", 0) != 0) ++line;
  std::string nested;
  for (int k = 0; k < 30000; ++k) nested += "n 0 s ";
  EXPECT_TRUE(holds(refusalWith(line, 2, nested), "cuts are nested too deeply"));
}

/// One region on the parameters [-1, 1], and a tree that leads to it along so many nodes.
MapContent chain(int nodes, std::uint64_t reduced_from) {
  MapContent content;
  content.reduced_from = reduced_from;
  content.name = "chain";
  content.solver_status = "complete";
  content.tolerance = 1e-8;
  content.parameters = {{"x", "m", -1.0, 1.0}};
  content.inputs = {{"u", "N", -10.0, 10.0}};
  content.planes = {1.0, 1.0, 1.0, -1.0};
  content.rows = {1, -2};
  content.laws = {0.5, 0.0};
  content.regions = {{0, 2, 0, 0, 0}};
  content.leaves = {{0, 1}};
  content.candidates = {0};
  content.root = nodes > 0 ? 0 : MapContent::kLeaf;
  for (int k = 1; k <= nodes; ++k) {
    content.planes.insert(content.planes.end(), {1.0, 2.0 * k / (nodes + 1) - 1.0});
    const auto next = static_cast<std::uint32_t>(k);
    content.nodes.push_back({next + 1, MapContent::kLeaf, k < nodes ? next : MapContent::kLeaf});
  }
  return content;
}

// The checker reads 1,998 nodes; that takes too long for a test.
TEST(ReductionDepth, AProofThatNestsTooDeeplyIsRefused) {
  const MapInMemory original(chain(0, 0));
  for (const int nodes : {1, 400}) {
    const MapInMemory reduced(chain(nodes, original.map().checksum()));
    const ReductionReport report = proofOf(reduced.map(), original.map());
    ASSERT_TRUE(report.passed()) << reductionText(report);
    EXPECT_EQ(reductionRefusal(report.certificate, reduced.bytes(), original.bytes()), "") << nodes;
  }
  const MapInMemory reduced(chain(1999, original.map().checksum()));
  EXPECT_TRUE(holds(errorOf([&] { proofOf(reduced.map(), original.map()); }),
                    "chain: region 0: its proof nests 2000 cuts"));
  EXPECT_TRUE(verifyReduction(reduced.map(), original.map()).passed());
}

TEST_F(ReductionCertificate, EveryCutAndEveryBitIsNoticed) {
  for (std::size_t size = 0; size < certificate_.size(); size += 1 + certificate_.size() / 200)
    EXPECT_NE(refusalOf(certificate_.substr(0, size)), "") << size;
  for (std::size_t bit = 0; bit < 8 * certificate_.size(); bit += 1 + certificate_.size() / 50) {
    std::string changed = certificate_;
    changed[bit / 8] = static_cast<char>(changed[bit / 8] ^ (1 << bit % 8));
    EXPECT_NE(refusalOf(changed), "") << bit;
  }
}

TEST_F(ReductionCertificate, BelongsToItsTwoMaps) {
  const MapInMemory other(gridMap(8, 3, cellsOf({"UUbL....", "UbcL....", "bcLc...."})));
  EXPECT_NE(reductionRefusal(certificate_, reduced_, other.bytes()), "");
  EXPECT_NE(reductionRefusal(certificate_, original_.bytes(), original_.bytes()), "");
  EXPECT_NE(reductionRefusal(certificate_, reduced_, reduced_), "");
}

TEST_F(ReductionCertificate, ThereIsNoneOfWhatIsRefuted) {
  MapContent changed = content_;
  changed.laws[2] += 1e-3;
  const ReductionReport report = proofOf(MapInMemory(changed).map(), original_.map());
  EXPECT_EQ(report.certificate, "");
  EXPECT_THROW(writeCertificate(report, "reduction.cert"), Error);
}

}  // namespace
}  // namespace polyfly
