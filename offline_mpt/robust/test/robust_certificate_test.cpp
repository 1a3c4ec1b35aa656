// The checker confirms the certificates of right robust maps, and refuses all that was changed.
#include <algorithm>
#include <cmath>

#include "../../test/map_in_memory.hpp"
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
  RobustMutation() : Mutation(smallProof().content, smallProof().proof.certificate) {}

  /// Why the certificate is refused after `line` was put before the first region.
  std::string refusalWith(const std::string& line) const {
    std::string text = certificate_;
    text.insert(text.find("\nregion 0\n") + 1, line + "\n");
    return refusal(sealed(text, map_), map_);
  }

  /// Why it is refused without one line that starts with `key`, for some of them. Empty where one is confirmed.
  std::string refusalWithout(const std::string& key) const {
    const std::vector<std::string> lines = linesOf(certificate_);
    std::string last = "nothing was tried";
    int count = 0;
    for (std::size_t k = 0; k < lines.size(); ++k) {
      if (lines[k].compare(0, key.size(), key) != 0 || count++ % 5 != 0) continue;
      std::vector<std::string> fewer = lines;
      fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(k));
      last = refusal(sealed(joined(fewer, "\n") + "\n", map_), map_);
      if (last.empty()) return last;
    }
    return last;
  }
};

/// What the checker says of a right certificate.
std::string confirmed(const ProvenRobust& proven) {
  EXPECT_TRUE(proven.proof.passed()) << proofText(proven.solved.problem, proven.proof);
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
  made[2] = twoStates();
  made[2].floor = "0.05";
  made[3].bounded_position = true;
  made[3].invariance = "first_step";
  made[4].references = true;
  made[4].horizon = 3;
  made[5].feedback = "zero";
  made[5].peak_in_map = true;
  for (const MadeRobust& one : made) {
    const ProvenRobust proven(one);
    const bool may_be_lost = confirmed(proven).find("MAY BE LOST") != std::string::npos;
    EXPECT_EQ(may_be_lost, proven.proof.lost.has_value()) << one.text();
  }
}

// Four steps are enough for this axis, three are not.
TEST(RobustCertificate, SaysWhereFeasibilityIsLost) {
  MadeRobust made;
  made.horizon = 3;
  EXPECT_NE(confirmed(ProvenRobust(made)).find("MAY BE LOST"), std::string::npos);
  made.horizon = 4;
  EXPECT_NE(confirmed(ProvenRobust(made)).find("feasibility is not lost"), std::string::npos);
}

TEST(RobustCertificate, ARefutedMapHasNone) {
  MapContent changed = smallProof().content;
  changed.laws[0] += 1e-6;
  const RobustProof proof = proveRobustMap(MapInMemory(changed).map(), smallProof().solved.problem);
  EXPECT_FALSE(proof.passed());
  EXPECT_EQ(proof.certificate, "");
}

TEST(RobustCertificate, ATreeThatMissesParametersIsRefuted) {
  MapContent changed = smallProof().content;
  ASSERT_GT(changed.leaves.size(), 1u);
  changed.leaves.assign(changed.leaves.size(), {0, 0});
  changed.candidates.clear();
  changed.tests.clear();
  const RobustProof proof = proveRobustMap(MapInMemory(changed).map(), smallProof().solved.problem);
  EXPECT_FALSE(proof.passed());
  EXPECT_EQ(proof.certificate, "");
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
       {"problem ", "tolerances ", "equalities ", "basis ", "convexity ", "coverage ", "regions ", "model ",
        "errors ", "predictions ", "half_space ", "point ", "simplex ", "inside ", "facet ", "leaf "})
    EXPECT_NE(refusalWithout(key), "") << key;
}

TEST_F(RobustMutation, NoLineIsGivenTwice) {
  for (const std::string& line : linesOf(certificate_)) {
    for (const char* key : {"model ", "errors ", "predictions ", "state_range ", "convexity ", "regions "}) {
      if (line.compare(0, std::string(key).size(), key) != 0) continue;
      EXPECT_NE(refusalWith(line), "") << line;
    }
  }
}

// Lines of other programs would weaken what is stated.
TEST_F(RobustMutation, LinesOfOtherCertificatesAreRefused) {
  for (const char* line : {"dropped 1 0", "relaxed 1 0", "implied 0", "counts b 0 0 1", "sliver_region 1 0",
                           "H 2 2 0x0p+0 0x0p+0 0x0p+0 0x0p+0", "unknown 1"})
    EXPECT_NE(refusalWith(line), "") << line;
  int tried = 0;
  EXPECT_NE(refusalOfLines("convexity ", setting(1, "definite"), tried), "");
  EXPECT_NE(refusalOfLines("convexity ", setting(1, "singular"), tried), "");
  EXPECT_NE(refusalOfLines("coverage ", setting(1, "widened"), tried), "");
  EXPECT_EQ(tried, 1);
}

// A bound of the input that always holds with equality would be a law that is optimal.
TEST_F(RobustMutation, NoHalfSpaceIsAnEquality) {
  int tried = 0;
  EXPECT_NE(
      refusalOfLines("equalities ", replacing({"equalities", "1", "0"}), tried).find("equalities or basis"),
      std::string::npos);
  EXPECT_NE(refusalOfLines("basis ", replacing({"basis", "1", "0"}), tried).find("equalities or basis"),
            std::string::npos);
  EXPECT_EQ(tried, 1);
}

// A plan before its size is known would have none, and the size of plans is limited, since rows are as long.
TEST_F(RobustMutation, PlansHaveASize) {
  std::vector<std::string> lines = linesOf(certificate_);
  const auto size = std::find_if(lines.begin(), lines.end(),
                                 [](const std::string& line) { return line.rfind("predictions ", 0) == 0; });
  ASSERT_NE(size, lines.end());
  const std::string huge = "predictions 99999999";
  std::vector<std::string> early = lines, long_plan = lines;
  long_plan[static_cast<std::size_t>(size - lines.begin())] = huge;
  EXPECT_NE(refusal(sealed(joined(long_plan, "\n") + "\n", map_), map_).find("out of range"),
            std::string::npos);
  early.insert(early.begin() + 4, "point 0 0 0 0 0");
  EXPECT_NE(refusal(sealed(joined(early, "\n") + "\n", map_), map_).find("predictions is missing"),
            std::string::npos);
}

TEST_F(RobustMutation, HalfSpacesAreChecked) {
  int tried = 0;
  const auto several = [](std::vector<std::string>& words) { return std::stoi(words[1]) > 1; };
  const auto enlarge = [&](std::vector<std::string>& words) {
    words[4] += "0";
    return several(words);
  };
  EXPECT_NE(refusalOfLines("half_space ", enlarge, tried), "");
  EXPECT_GT(tried, 3);
  const auto negate = [](std::vector<std::string>& words) {
    words[4] = "-" + words[4];
    return true;
  };
  EXPECT_NE(refusalOfLines("half_space ", negate, tried).find("not positive"), std::string::npos);
  const auto turn = [&](std::vector<std::string>& words) {
    if (words[3].size() < 2) return false;
    words[3][1] = words[3][1] == '+' ? '-' : '+';
    return true;
  };
  EXPECT_NE(refusalOfLines("half_space ", turn, tried), "");
  EXPECT_GT(tried, 3);
  EXPECT_NE(refusalOfLines("half_space ", setting(3, "s+++++++++++"), tried).find("number of signs"),
            std::string::npos);
  EXPECT_NE(refusalOfLines("half_space ", setting(2, "9999"), tried).find("not there"), std::string::npos);
}

// A row that is stricter is not met by all plans.
TEST_F(RobustMutation, RowsAreChecked) {
  int tried = 0;
  EXPECT_NE(refusalOfLines("row ", setting(1, "-64"), tried), "");
  EXPECT_GT(tried, 10);
  const auto enlarge = [](std::vector<std::string>& words) {
    words.back() += "000";
    return words.back()[0] != '0';
  };
  EXPECT_NE(refusalOfLines("row ", enlarge, tried), "");
  EXPECT_NE(refusalOfLines("predictions ", setting(1, "1"), tried), "");
}

TEST_F(RobustMutation, PointsAreChecked) {
  const std::size_t words_of_y = 4;
  for (std::size_t word = 1; word <= words_of_y; ++word) {
    int tried = 0;
    EXPECT_NE(refusalOfLines("point ", setting(word, "11/10"), tried), "") << word;
    EXPECT_GT(tried, 10);
  }
  int tried = 0;
  const auto last = [](std::vector<std::string>& words) {
    words.back() = "10";
    return true;
  };
  EXPECT_NE(refusalOfLines("point ", last, tried), "");
  const auto longer = [](std::vector<std::string>& words) {
    words.emplace_back("0");
    return true;
  };
  EXPECT_NE(refusalOfLines("point ", longer, tried).find("number of predictions"), std::string::npos);
}

TEST_F(RobustMutation, SimplicesAreChecked) {
  int tried = 0;
  const auto repeat = [](std::vector<std::string>& words) {
    words[2] = words[3];
    return true;
  };
  EXPECT_NE(refusalOfLines("simplex ", repeat, tried), "");
  EXPECT_GT(tried, 10);
  for (const int step : {1, 5}) {
    const auto other = [step](std::vector<std::string>& words) {
      words[2] = std::to_string((std::stoi(words[2]) + step) % 10);
      return true;
    };
    EXPECT_NE(refusalOfLines("simplex ", other, tried), "") << step;
  }
  EXPECT_NE(refusalOfLines("simplex ", setting(1, "100"), tried), "");
  EXPECT_NE(refusalOfLines("simplex ", setting(2, "99999"), tried), "");
}

TEST_F(RobustMutation, TheModelIsChecked) {
  int tried = 0;
  const auto with = [&](const std::string& name, std::size_t word, const std::string& text) {
    const auto change = [=](std::vector<std::string>& words) {
      if (words[1] != name) return false;
      words[word] = text;
      return true;
    };
    return refusalOfLines("model ", change, tried);
  };
  EXPECT_NE(with("A", 4, "10").find("after one step"), std::string::npos);
  EXPECT_NE(with("B", 5, "-10").find("after one step"), std::string::npos);
  EXPECT_NE(with("G", 5, "1").find("after one step"), std::string::npos);
  EXPECT_NE(with("drift", 5, "1").find("after one step"), std::string::npos);
  EXPECT_NE(with("C", 4, "10").find("greater than tau"), std::string::npos);
  EXPECT_NE(with("input_range", 5, "1/100").find("input is out of its range"), std::string::npos);
  EXPECT_NE(with("tie_gain", 4, "1"), "");
  EXPECT_NE(with("input_shift", 4, "1"), "");
  EXPECT_NE(with("state_shift", 4, "1"), "");
  EXPECT_NE(with("range", 2, "1"), "");
  EXPECT_NE(with("A", 1, "Z"), "");
  EXPECT_EQ(tried, 1);
  EXPECT_NE(refusalOfLines("state_range ", setting(3, "1/100"), tried).find("a state is out of its range"),
            std::string::npos);
  EXPECT_NE(refusalOfLines("state_range ", setting(1, "7"), tried), "");
  EXPECT_NE(refusalOfLines("errors ", replacing({"errors", "2", "1", "0"}), tried), "");
  EXPECT_NE(refusalOfLines("errors ", replacing({"errors", "2", "0", "0"}), tried), "");
}

TEST_F(RobustMutation, ProofsOfRegionsAreChecked) {
  int tried = 0;
  const auto negate = [](std::vector<std::string>& words) {
    words.back() = "-" + words.back();
    return true;
  };
  EXPECT_NE(refusalOfLines("follows ", negate, tried), "");
  EXPECT_GT(tried, 5);
  const auto edge = [](std::vector<std::string>& words) {
    if (words[3] != "edge") return false;
    words.back() = "-" + words.back();
    return true;
  };
  EXPECT_NE(refusalOfLines("facet ", edge, tried), "");
  EXPECT_GT(tried, 3);
  const auto origin = [](std::vector<std::string>& words) {
    words[2] = words[2][0] + std::to_string(std::stoi(words[2].substr(1)) ^ 1);
    return true;
  };
  EXPECT_NE(refusalOfLines("facet ", origin, tried), "");
  EXPECT_NE(refusalOfLines("inside ", setting(1, "1"), tried), "");
}

}  // namespace
}  // namespace polyfly
