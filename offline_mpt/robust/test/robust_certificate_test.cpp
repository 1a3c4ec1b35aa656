// The checker confirms the certificates of right robust maps, and refuses all that was changed.
#include <algorithm>
#include <cmath>

#include "../../test/mutation.hpp"
#include "json_problem.hpp"
#include "proven_robust.hpp"
#include "robust/read_map_certificate.hpp"

namespace polyfly {
namespace {

MadeRobust twoStates() {
  MadeRobust made;
  made.states = 2;
  made.horizon = 3;
  return made;
}

const ProvenRobust& smallProof() {
  static const ProvenRobust proven(twoStates());
  return proven;
}

class RobustMutation : public Mutation {
 protected:
  RobustMutation() : Mutation(Subject(smallProof().content, smallProof().proof.certificate)) {}

  /// Why the certificate is refused after `line` was put before the first region.
  std::string refusalWith(const std::string& line) const {
    std::string text = certificate_;
    text.insert(text.find("\nregion 0\n") + 1, line + "\n");
    return refusal(sealed(text, map_), map_);
  }
};

/// No proof of the map succeeds.
void expectRefuted(const MapContent& changed) {
  const RobustProof proof = proveRobustMap(MapInMemory(changed).map(), smallProof().solved.problem);
  EXPECT_FALSE(proof.passed());
  EXPECT_EQ(proof.certificate, "");
}

/// What the checker says of a right certificate.
std::string confirmed(const ProvenRobust& proven) {
  EXPECT_TRUE(proven.proof.passed()) << proofText(proven.solved.problem, proven.proof);
  EXPECT_LT(proven.proof.law_error, 1e-11);  // in the whole box
  EXPECT_LT(proven.proof.plane_error, 1e-12);
  const checker::Map map(bytesOf(proven.content));
  const auto certificate = checker::readMapCertificate(proven.proof.certificate, map);
  checker::compareProblem(*certificate, map, proven.solved.problem.text);
  certificate->check();
  return certificate->conditions();
}

TEST(RobustCertificate, RightMapsAreConfirmed) {
  std::vector<MadeRobust> made(6, smallRobust());
  made[1].stack = "shift";
  made[1].torque = true;
  made[2].states = 2;
  made[2].floor = "0.05";
  made[3].bounded_position = true;
  made[3].invariance = "first_step";
  made[4].references = true;
  made[4].horizon = 3;
  made[5].feedback = "zero";
  made[5].peak_in_map = true;
  for (const MadeRobust& one : made) {
    const ProvenRobust proven(one);
    EXPECT_EQ(bool(holds(confirmed(proven), "MAY BE LOST")), proven.proof.lost.has_value()) << one.text();
  }
}

// Four steps are enough for this axis, three are not.
TEST(RobustCertificate, SaysWhereFeasibilityIsLost) {
  MadeRobust made;
  made.horizon = 3;
  EXPECT_TRUE(holds(confirmed(ProvenRobust(made)), "MAY BE LOST"));
  made.horizon = 4;
  EXPECT_TRUE(holds(confirmed(ProvenRobust(made)), "feasibility is not lost"));
}

TEST(RobustCertificate, ARefutedMapHasNone) {
  MapContent changed = smallProof().content;
  changed.laws[0] += 1e-6;
  expectRefuted(changed);
}

TEST(RobustCertificate, ATreeThatMissesParametersIsRefuted) {
  MapContent changed = smallProof().content;
  ASSERT_GT(changed.leaves.size(), 1u);
  changed.leaves.assign(changed.leaves.size(), {0, 0});
  changed.candidates.clear();
  changed.tests.clear();
  expectRefuted(changed);
}

TEST_F(RobustMutation, NothingChangedIsConfirmed) {
  EXPECT_EQ(refusal(certificate_, map_), "");
  EXPECT_EQ(refusal(sealed(certificate_, map_), map_), "");
}

TEST_F(RobustMutation, AnyByteOfTheCertificateIsCaught) {
  for (std::size_t at = 0; at < certificate_.size(); at += 97) {
    std::string changed = certificate_;
    changed[at] ^= static_cast<char>(1 + at % 7);
    EXPECT_NE(refusal(changed, map_), "") << at;
  }
}

TEST_F(RobustMutation, TheKindIsChecked) {
  for (const char* title : {"polyfly certificate 6", "polyfly robust certificate 3"}) {
    std::string changed = certificate_;
    changed.replace(0, changed.find('\n'), title);
    EXPECT_NE(refusal(sealed(changed, map_), map_), "") << title;
  }
}

TEST_F(RobustMutation, EntriesOfTheMapAreChecked) {
  // Gains of some hundred make the law tolerance, which is relative, as great as 1e-6.
  for (std::size_t k = 0; k < content_.laws.size(); ++k) {
    MapContent changed = content_;
    changed.laws[k] += 1e-4 * (1.0 + std::abs(changed.laws[k]));
    const std::string reason = refusalOfMap(changed);
    EXPECT_NE(reason.find("law"), std::string::npos) << k << ": " << reason;
  }
  for (std::size_t k = 0; k < content_.planes.size(); ++k) {
    MapContent changed = content_;
    changePlane(changed, k, 1e-6);
    EXPECT_NE(refusalOfMap(changed).find("plane"), std::string::npos) << k;
  }
  const auto facets = static_cast<int>(smallProof().solved.set.facets.size());
  for (std::size_t k = 0; k < content_.active.size(); ++k) {
    for (const int wrong : {(content_.active[k] + 1) % facets, facets}) {
      MapContent changed = content_;
      changed.active[k] = wrong;
      EXPECT_NE(refusalOfMap(changed), "") << k << " " << wrong;
    }
  }
}

TEST_F(RobustMutation, AWrongTreeIsCaught) {
  MapContent changed = content_;
  ASSERT_FALSE(changed.nodes.empty());
  std::swap(changed.nodes[0].below, changed.nodes[0].above);
  EXPECT_NE(refusalOfMap(changed), "");
  for (std::size_t leaf = 0; leaf < content_.leaves.size(); ++leaf) {
    if (content_.leaves[leaf].count == 0) continue;
    changed = content_;
    changed.leaves[leaf].count = 0;
    EXPECT_NE(refusalOfMap(changed), "") << leaf;
  }
}

TEST_F(RobustMutation, NoLineCanBeLeftOut) {
  for (const char* key :
       {"problem", "tolerances", "equalities", "basis", "convexity", "coverage", "regions", "model", "errors",
        "predictions", "half_space", "point", "simplex", "inside", "facet", "leaf"})
    expectRefused(key, leavingOut());
}

TEST_F(RobustMutation, NoLineIsGivenTwice) {
  for (const char* key : {"model", "errors", "predictions", "state_range", "convexity", "regions"})
    expectRefused(key, repeating());
}

// Lines of other programs would weaken what is stated.
TEST_F(RobustMutation, LinesOfOtherCertificatesAreRefused) {
  for (const char* line : {"dropped 1 0", "relaxed 1 0", "implied 0", "counts b 0 0 1", "sliver_region 1 0",
                           "H 2 2 0x0p+0 0x0p+0 0x0p+0 0x0p+0", "unknown 1"})
    EXPECT_NE(refusalWith(line), "") << line;
  expectRefused("convexity", setting(1, "definite"));
  expectRefused("convexity", setting(1, "singular"));
  expectRefused("coverage", setting(1, "widened"));
}

// A bound of the input that always holds with equality would be a law that is optimal.
TEST_F(RobustMutation, NoHalfSpaceIsAnEquality) {
  expectRefused("equalities", replacing({"equalities", "1", "0"}), 1, "equalities or basis");
  expectRefused("basis", replacing({"basis", "1", "0"}), 1, "equalities or basis");
}

// A plan before its size is known would have none, and the size of plans is limited, since rows are as long.
TEST_F(RobustMutation, PlansHaveASize) {
  expectRefused("predictions", setting(1, "99999999"), 1, "out of range");
  Words early = linesOf(certificate_);
  early.insert(early.begin() + 4, "point 0 0 0 0 0");
  EXPECT_TRUE(holds(refusalOfLines(early), "predictions is missing"));
}

TEST_F(RobustMutation, HalfSpacesAreChecked) {
  const auto several = [](Words& words) { return std::stoi(words[1]) > 1; };
  const auto enlarge = [&](Words& words) {
    words[4] += "0";
    return several(words);
  };
  expectRefused("half_space", enlarge, 4);
  const auto negate = [](Words& words) {
    words[4] = "-" + words[4];
    return true;
  };
  expectRefused("half_space", negate, 1, "not positive");
  const auto turn = [&](Words& words) {
    if (words[3].size() < 2) return false;
    words[3][1] = words[3][1] == '+' ? '-' : '+';
    return true;
  };
  expectRefused("half_space", turn, 4);
  expectRefused("half_space", setting(3, "s+++++++++++"), 1, "number of signs");
  expectRefused("half_space", setting(2, "9999"), 1, "not there");
}

// A row that is stricter is not met by all plans.
TEST_F(RobustMutation, RowsAreChecked) {
  expectRefused("row", setting(1, "-64"), 11);
  const auto enlarge = [](Words& words) {
    words.back() += "000";
    return words.back()[0] != '0';
  };
  expectRefused("row", enlarge);
  expectRefused("predictions", setting(1, "1"));
}

TEST_F(RobustMutation, PointsAreChecked) {
  const std::size_t words_of_y = 4;
  for (std::size_t word = 1; word <= words_of_y; ++word) expectRefused("point", setting(word, "11/10"), 11);
  const auto last = [](Words& words) {
    words.back() = "10";
    return true;
  };
  expectRefused("point", last);
  const auto longer = [](Words& words) {
    words.emplace_back("0");
    return true;
  };
  expectRefused("point", longer, 1, "number of predictions");
}

TEST_F(RobustMutation, SimplicesAreChecked) {
  const auto repeat = [](Words& words) {
    words[2] = words[3];
    return true;
  };
  expectRefused("simplex", repeat, 11);
  for (const std::size_t step : {1, 5}) expectRefused("simplex", stepping(2, step, 10));
  expectRefused("simplex", setting(1, "100"));
  expectRefused("simplex", setting(2, "99999"));
}

TEST_F(RobustMutation, TheModelIsChecked) {
  const auto expectWrong = [&](const std::string& name, std::size_t word, const std::string& text,
                               const std::string& part = "") {
    expectRefused("model", where(1, name, setting(word, text)), 1, part);
  };
  expectWrong("A", 4, "10", "after one step");
  expectWrong("B", 5, "-10", "after one step");
  expectWrong("G", 5, "1", "after one step");
  expectWrong("drift", 5, "1", "after one step");
  expectWrong("C", 4, "10", "greater than tau");
  expectWrong("input_range", 5, "1/100", "input is out of its range");
  expectWrong("tie_gain", 4, "1");
  expectWrong("input_shift", 4, "1");
  expectWrong("state_shift", 4, "1");
  expectWrong("range", 2, "1");
  expectWrong("A", 1, "Z");
  expectRefused("state_range", setting(3, "1/100"), 1, "a state is out of its range");
  expectRefused("state_range", setting(1, "7"));
  expectRefused("errors", replacing({"errors", "2", "1", "0"}));
  expectRefused("errors", replacing({"errors", "2", "0", "0"}));
}

TEST_F(RobustMutation, ProofsOfRegionsAreChecked) {
  expectRefused("follows", negatingLast(), 6);
  expectRefused("facet", where(3, "edge", negatingLast()), 4);
  const auto origin = [](Words& words) {
    words[2] = words[2][0] + std::to_string(std::stoi(words[2].substr(1)) ^ 1);
    return true;
  };
  expectRefused("facet", origin);
  expectRefused("inside", setting(1, "1"));
}

}  // namespace
}  // namespace polyfly
