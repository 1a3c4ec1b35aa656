// What a certificate says of look-ups: wrong trees and wrong proofs are refused.
#include <algorithm>
#include <cmath>
#include <random>

#include "core/text.hpp"
#include "error_of.hpp"
#include "mutation.hpp"

namespace polyfly {
namespace {

constexpr double kDifference = 1e-6;  // of inputs: a greater one is a wrong answer

/// Changes of a map that leave it well-formed, judged by its answers at random parameters.
class LookupMutation : public Mutation {
 protected:
  explicit LookupMutation(const Subject& subject = once([] { return doubleIntegrator(5); }))
      : Mutation(subject) {
    std::mt19937 random(1);
    for (int k = 0; k < kSamples; ++k) {
      for (const Signal& parameter : content_.parameters) {
        const double share = static_cast<double>(random()) / static_cast<double>(std::mt19937::max());
        samples_.push_back(parameter.lower + share * (parameter.upper - parameter.lower));
      }
    }
  }

  /// Whether look-ups in the changed map answer otherwise than the right map does when it tests all its regions.
  bool answersWrongly(const MapContent& changed) const {
    const MapInMemory right(content_), wrong(changed);
    const std::size_t p = content_.parameters.size();
    for (std::size_t k = 0; k < samples_.size(); k += p) {
      const double* const theta = samples_.data() + k;
      const Lookup expected = right.map().locateExhaustively(theta), found = wrong.map().locate(theta);
      if (found.status != expected.status) return true;
      if (found.status == LookupStatus::kInside && !sameInputs(expected.law, found.law, theta)) return true;
    }
    return false;
  }

  bool sameInputs(std::size_t law, std::size_t other, const double* theta) const {
    const std::size_t p = content_.parameters.size(), size = content_.inputs.size() * (p + 1);
    for (std::size_t row = 0; row < size; row += p + 1) {
      const double* const a = content_.laws.data() + law * size + row;
      const double* const b = content_.laws.data() + other * size + row;
      double difference = a[p] - b[p];
      for (std::size_t j = 0; j < p; ++j) difference += (a[j] - b[j]) * theta[j];
      if (std::abs(difference) > kDifference) return false;
    }
    return true;
  }

  /// Whether the reader takes the map. It refuses trees that are not well-formed.
  static bool isReadable(const MapContent& changed) {
    return errorOf([&] { MapInMemory map(changed); }) == "no error";
  }

  /// The certificate of the right map is refused, and no new proof succeeds.
  CertifyReport expectRefuted(const MapContent& changed) const {
    EXPECT_NE(refusalOfMap(changed), "");
    CertifyReport report = certified(changed, program_);
    EXPECT_FALSE(report.passed());
    return report;
  }

  /// So is each tree that answers wrongly of so many with one changed field.
  void expectWrongTreesRefuted(unsigned seed, int count, int least) const {
    std::mt19937 random(seed);
    int wrong = 0;
    for (int k = 0; k < count; ++k) {
      const MapContent changed = changedTree(random);
      if (!isReadable(changed) || !answersWrongly(changed)) continue;
      ++wrong;
      SCOPED_TRACE(k);
      for (const Defect& defect : expectRefuted(changed).defects)
        EXPECT_EQ(defect.kind, Defect::Kind::kLookup) << defect.text;
    }
    EXPECT_GE(wrong, least);
  }

  /// A change of one field of the tree.
  MapContent changedTree(std::mt19937& random) const {
    MapContent changed = content_;
    const auto any = [&](std::size_t count) { return static_cast<std::uint32_t>(random() % count); };
    MapContent::Node& node = changed.nodes[any(changed.nodes.size())];
    MapContent::Leaf& leaf = changed.leaves[any(changed.leaves.size())];
    switch (any(9)) {
      case 0:
        node.plane = any(changed.planes.size() / (changed.parameters.size() + 1));
        break;
      case 1:
        std::swap(node.below, node.above);
        break;
      case 2:
        (any(2) == 0 ? node.below : node.above) = any(changed.leaves.size()) | MapContent::kLeaf;
        break;
      case 3:
        leaf.count = any(leaf.count + 1);
        break;
      case 4:
        changed.candidates[any(changed.candidates.size())] = any(changed.regions.size());
        break;
      case 5:
        changed.tests[any(changed.tests.size())] &= ~(1u << any(8));
        break;
      case 6:
        changed.tests[any(changed.tests.size())] = 0;
        break;
      case 7:
        changed.root = any(changed.leaves.size()) | MapContent::kLeaf;
        break;
      default:
        std::swap(leaf, changed.leaves[any(changed.leaves.size())]);
        break;
    }
    return changed;
  }

  static constexpr int kSamples = 2000;
  std::vector<double> samples_;
};

TEST_F(LookupMutation, NoTreeThatAnswersWronglyIsProvenOrConfirmed) {
  ASSERT_FALSE(answersWrongly(content_));
  expectWrongTreesRefuted(2, 1000, 201);
}

// A look-up takes the first one, whatever rows the second one names.
TEST_F(LookupMutation, ACandidateThatALeafNamesTwice) {
  MapContent changed = content_;
  const auto at = static_cast<std::ptrdiff_t>(changed.leaves.front().first);
  changed.candidates.insert(changed.candidates.begin() + at,
                            changed.candidates[changed.leaves.front().first]);
  changed.tests.insert(changed.tests.begin() + at, 0);
  ++changed.leaves.front().count;
  for (std::size_t k = 1; k < changed.leaves.size(); ++k) ++changed.leaves[k].first;
  const CertifyReport report = expectRefuted(changed);
  ASSERT_EQ(report.defects.size(), 1u);
  EXPECT_TRUE(holds(report.defects.front().text, "twice"));
}

TEST_F(LookupMutation, AllLeavesButOneEmptied) {
  for (const std::size_t kept : {std::size_t{0}, content_.leaves.size() / 2}) {
    MapContent changed = content_;
    for (std::size_t k = 0; k < changed.leaves.size(); ++k) {
      if (k != kept) changed.leaves[k].count = 0;
    }
    expectRefuted(changed);
  }
}

TEST_F(LookupMutation, AnEmptiedLeafIsToldWithAParameterThatItMisses) {
  MapContent changed = content_;
  changed.leaves.front().count = 0;
  const CertifyReport report = certified(changed, program_);
  ASSERT_EQ(report.defects.size(), 1u);
  ASSERT_EQ(report.defects.front().witness.size(), 2);
  const MapInMemory right(content_), wrong(changed);
  const double* const theta = report.defects.front().witness.data();
  EXPECT_EQ(right.map().locate(theta).status, LookupStatus::kInside);
  EXPECT_EQ(wrong.map().locate(theta).status, LookupStatus::kOutsidePartition);
}

TEST_F(LookupMutation, AMapThatIsNotCompleteIsRefused) {
  for (const char* status : {"limited", "incomplete", "", "complete "}) {
    MapContent changed = content_;
    changed.solver_status = status;
    EXPECT_TRUE(holds(refusalOfMap(changed), "status"));
    EXPECT_FALSE(certified(changed, program_).passed()) << status;
  }
}

std::string withTolerance(const std::string& map, double tolerance) {
  constexpr std::size_t kTolerance = 56;  // FORMAT.md
  return withBytes(map, kTolerance, std::string(reinterpret_cast<const char*>(&tolerance), sizeof tolerance));
}

TEST_F(LookupMutation, TheToleranceIsLimited) {
  ASSERT_EQ(refusal(sealed(certificate_, map_), withTolerance(map_, content_.tolerance)), "");
  for (const double tolerance : {0.0, -1e-8, 1e-13, 1.1e-8, 1e-3, 0.1, 1.0, 1e300, std::nan("")}) {
    const std::string map = withTolerance(map_, tolerance);
    EXPECT_NE(refusal(sealed(certificate_, map), map), "") << tolerance;
  }
}

TEST_F(LookupMutation, ARowThatIsNotTestedMustFollowFromOthers) {
  std::size_t cleared = 0;
  for (std::size_t k = 0; k < content_.tests.size(); ++k) {
    for (unsigned bit = 0; bit < 31; ++bit) {
      if ((content_.tests[k] >> bit & 1u) == 0) continue;
      MapContent changed = content_;
      changed.tests[k] ^= 1u << bit;
      if (!answersWrongly(changed)) continue;
      ++cleared;
      EXPECT_NE(refusalOfMap(changed), "") << k << " " << bit;
    }
  }
  EXPECT_GT(cleared, 0u);
}

// Lines of the proof. All checksums are right.

TEST_F(LookupMutation, EveryLineOfTheProofIsNeeded) {
  const Words lines = linesOf(certificate_);
  int tried = 0;
  for (std::size_t k = 0; k < lines.size(); ++k) {
    const std::string kind = lines[k].substr(0, lines[k].find(' '));
    if (kind != "drop" && kind != "leaf" && kind != "outside") continue;
    Words changed = lines;
    changed[k].clear();
    EXPECT_NE(refusalOfLines(changed), "") << lines[k];
    changed[k] = lines[k] + "\n" + lines[k];
    if (kind == "leaf") {
      EXPECT_NE(refusalOfLines(changed), "") << lines[k];
    }
    ++tried;
  }
  EXPECT_GT(tried, 20);
}

TEST_F(LookupMutation, DroppedRowsAreChecked) {
  const auto negate = [](Words& words) { return negatingLast()(words) && words.size() > 5; };
  expectRefused("drop", negate, 6);
  // Scale, row, region, place.
  for (const Change& change :
       {setting(4, "0"), setting(4, "-1"), setting(3, "99"), setting(1, "9999"), setting(6, "99")})
    expectRefused("drop", change);
  const auto weightless = [](Words& words) {
    words[5] = "0";
    words.resize(6);
    return true;
  };
  expectRefused("drop", weightless);
}

TEST_F(LookupMutation, StartingPointsAreChecked) {
  expectRefused("leaf walk", setting(2, "999"), 6);
  for (const char* share : {"0", "-1/10000000000", "1"}) expectRefused("leaf walk", setting(3, share));
  // Where no row is tested near the point, any share up to about one is as good.
  const auto enlarge = [](Words& words) {
    if (checker::Line(words[3]).fraction() > mpq_class(1, 0x10000)) return false;
    words[3] = "1/100";
    return true;
  };
  expectRefused("leaf walk", enlarge, 6);
  expectRefused("leaf walk", setting(4, "2"));
  expectRefused("leaf walk", setting(4, "-1/1"));
  expectRefused("leaf walk", replacing({"leaf", "walk", "0", "1/10000000000"}));
  expectRefused("leaf", replacing({"leaf", "cover", "e", "1", "0", "1"}));
}

TEST_F(LookupMutation, RegionsThatDoNotReachIntoALeafAreChecked) {
  // The greatest weight: one that is far smaller may change within what the box absorbs.
  const auto enlarge = [](Words& words) {
    std::size_t greatest = 4;  // outside REGION COUNT PLACE WEIGHT ...
    for (std::size_t k = 4; k < words.size(); k += 2) {
      if (words[k].size() > words[greatest].size()) greatest = k;
    }
    words[greatest] += "000";
    return true;
  };
  expectRefused("outside", setting(1, "9999"));
  expectRefused("outside", setting(2, "0"));
  expectRefused("outside", setting(3, "99"));
  expectRefused("outside", enlarge);
}

/// Regions that reach into leaves by less than the plane tolerance.
class NearRegionMutation : public LookupMutation {
 protected:
  NearRegionMutation() : LookupMutation(once([] { return nearlyMeeting(4, 3, 1e-9, 7); })) {}
};

TEST_F(NearRegionMutation, RegionsNearCandidatesAreChecked) {
  EXPECT_EQ(refusal(certificate_, map_), "");
  expectRefused("near", setting(1, "9999"), 6);
  expectRefused("near", setting(3, "999"));
  expectRefused("near", setting(2, "b"));
  expectRefused("near", setting(2, "e"));
  expectRefused("near", droppingLast());
}

TEST_F(NearRegionMutation, SliversAreChecked) {
  expectRefused("sliver", setting(1, "0"), 4);  // a region of the map
  expectRefused("sliver", setting(1, "9999"));
  expectRefused("sliver", setting(0, "beyond"));
  // Proofs of other kinds, which show less.
  // A sliver that does not reach into a leaf may be near its candidates too: that is as true.
  const auto named = [this](const std::string& word) {
    return [this, word](Words& words) {
      if (word == "sliver" && std::stoul(words[1]) >= content_.regions.size()) return false;
      words.resize(word == "sliver" ? 2 : words.size());
      words[0] = word;
      return true;
    };
  };
  expectRefused("outside", named("sliver"));
  expectRefused("outside", named("beyond"));
}

TEST_F(NearRegionMutation, NoTreeThatAnswersWronglyIsProvenOrConfirmed) {
  expectWrongTreesRefuted(3, 100, 11);
}

/// A right map one leaf of which has no interior. It has all regions as candidates: rounding may lead there.
class FlatLeafMutation : public LookupMutation {
 protected:
  FlatLeafMutation() {
    const auto is_leaf = [](const MapContent::Node& node) { return (node.below & MapContent::kLeaf) != 0; };
    const auto at = std::find_if(content_.nodes.begin(), content_.nodes.end(), is_leaf);
    const auto flat = static_cast<std::uint32_t>(content_.leaves.size()) | MapContent::kLeaf;
    const MapContent::Node repeated = {at->plane, at->below, flat};
    at->below = static_cast<std::uint32_t>(content_.nodes.size());
    content_.nodes.push_back(repeated);
    content_.leaves.push_back({static_cast<std::uint32_t>(content_.candidates.size()),
                               static_cast<std::uint32_t>(content_.regions.size())});
    for (std::uint32_t region = 0; region < content_.regions.size(); ++region) {
      content_.candidates.push_back(region);
      content_.tests.push_back((1u << content_.regions[region].row_count) - 1);
    }
    map_ = bytesOf(content_);
    const CertifyReport report = certified(content_, program_);
    EXPECT_TRUE(report.passed()) << certifyText(report);
    certificate_ = report.certificate;
  }
};

TEST_F(FlatLeafMutation, ItsCoverIsConfirmed) {
  EXPECT_EQ(refusal(certificate_, map_), "");
  EXPECT_TRUE(holds(certificate_, "\nleaf cover "));
}

TEST_F(FlatLeafMutation, ItsCoverIsChecked) {
  const auto without = [](const std::string& kind) {
    return [kind](Words& words) {
      const auto at = std::find(words.begin(), words.end(), kind);
      if (at == words.end()) return false;
      words.erase(at, at + (kind == "b" ? 3 : 2));
      return true;
    };
  };
  expectRefused("leaf cover", droppingLast());
  expectRefused("leaf cover", without("N"));
  expectRefused("leaf cover", without("b"));
  expectRefused("leaf cover", replacing({"leaf", "cover", "e", "1", "0", "1"}));
}

TEST_F(FlatLeafMutation, AllCandidatesOfItAreNeeded) {
  MapContent changed = content_;
  changed.leaves.back().count = 0;
  expectRefuted(changed);
}

}  // namespace
}  // namespace polyfly
