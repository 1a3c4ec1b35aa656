// check_problem: model and rows of a robust map's certificate against the problem file, by arithmetic of its own.
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "../../test/mutation.hpp"
#include "problem/invariance.hpp"
#include "problem/robust_match.hpp"
#include "proven_robust.hpp"
#include "random_robust.hpp"
#include "robust/read_map_certificate.hpp"
#include "robust_mpc/robust_program.hpp"

namespace polyfly {
namespace {

const mpq_class kTolerance(1, 1000000000000);

checker::RobustMatch matchOf(const std::string& certificate, const MapContent& content,
                             const std::string& text) {
  const checker::Map map(bytesOf(content));
  const auto read = checker::readMapCertificate(certificate, map);
  const auto* const robust = dynamic_cast<const checker::RobustCertificate*>(read.get());
  if (robust == nullptr) throw checker::Refused("is no robust certificate");
  return checker::matchRobust(*robust, checker::readRobustProblem(text), kTolerance);
}

/// Empty: model and rows are those of the problem. Else why they are not.
std::string refusalOf(const std::string& certificate, const MapContent& content, const std::string& text) {
  return polyfly::refusalOf([&] { matchOf(certificate, content, text); });
}

std::string refusalOf(const ProvenRobust& proven, const std::string& text) {
  return refusalOf(proven.proof.certificate, proven.content, text);
}

MadeRobust withReferences() {
  MadeRobust made;
  made.horizon = 3;
  made.references = true;
  made.torque = true;
  return made;
}

const ProvenRobust& referenceProof() {
  static const ProvenRobust proven(withReferences());
  return proven;
}

TEST(RobustRows, AreThoseOfMadeProblems) {
  std::vector<MadeRobust> made(6);
  for (MadeRobust& one : made) one.horizon = 3;
  made[0].stack = "shift";
  made[1].feedback = "fixed";
  made[1].horizon = 4;
  made[2].feedback = "zero";
  made[2].peak_in_map = true;
  made[3].states = 2;
  made[3].floor = "5e-2";
  made[3].outputs = "[[1, 0], [\"1/3\", 0.25]]";
  made[4].disturbance = "[-0.1, 0.4]";
  made[5].states = 4;
  for (const MadeRobust& one : made) {
    const ProvenRobust proven(one);
    ASSERT_NE(proven.proof.certificate, "");
    EXPECT_EQ(refusalOf(proven, one.text()), "") << one.text();
  }
}

TEST(RobustRows, AreThoseOfDrawnProblems) {
  int tried = 0;
  for (std::uint64_t seed = 1; tried < 4 && seed < 40; ++seed) {
    const std::string text = RandomRobust(seed, 3).text();
    const RobustProblem problem = parseRobustProblem(text, "drawn.yaml");
    if (problem.stateCount() > 3 || problem.parameterCount() > 3) continue;  // others take long to prove
    const ProvenRobust proven(problem);
    if (proven.proof.certificate.empty()) continue;
    ++tried;
    EXPECT_EQ(refusalOf(proven, text), "") << text;
  }
  EXPECT_EQ(tried, 4);
}

MadeRobust withoutInvariance() {
  MadeRobust made;
  made.states = 2;
  made.horizon = 3;
  made.bounded_position = true;
  made.input = "[-3, 3]";
  return made;
}

TEST(RobustRows, OfAnInvariantSetBoundTheFirstStepOrTheLast) {
  MadeRobust made = withoutInvariance();
  const ProvenRobust without(made);
  for (const char* const rule : {"first_step", "terminal"}) {
    made.invariance = rule;
    const ProvenRobust proven(made);
    const checker::RobustMatch match = matchOf(proven.proof.certificate, proven.content, made.text());
    EXPECT_GT(match.invariance_rows, 4u);
    EXPECT_TRUE(match.is_greatest);
    for (const char* const other : {"first_step", "terminal", "none"}) {
      const std::string text =
          replaced(made.text(), std::string("invariance: ") + rule, std::string("invariance: ") + other);
      EXPECT_EQ(refusalOf(proven, text).empty(), std::string(rule) == other) << rule << " " << other;
    }
    EXPECT_NE(refusalOf(without, made.text()), "");
    made.stack = "shift";
    made.feedback = "fixed";
  }
}

std::vector<checker::ExactHalfSpace> greatestSet(const MadeRobust& made) {
  std::vector<checker::ExactHalfSpace> set;
  for (const ExactHalfSpace& row : invariantParameters(made.problem()).rows) set.push_back({row.a, row.b});
  return set;
}

// The greatest set of tighter bounds is invariant within the wider ones, and a smaller set than the greatest there.
TEST(RobustRows, ASmallerInvariantSetIsNotTheGreatest) {
  MadeRobust made = withoutInvariance();
  made.invariance = "first_step";
  const ProvenRobust proven(made);
  const checker::Map map(bytesOf(proven.content));
  const auto read = checker::readMapCertificate(proven.proof.certificate, map);
  const auto& certificate = dynamic_cast<const checker::RobustCertificate&>(*read);
  const checker::RobustProblem problem = checker::readRobustProblem(made.text());
  MadeRobust tighter = made;
  tighter.input = "[-2, 2.5]";
  for (const auto& [set, is_greatest] :
       {std::pair(greatestSet(made), true), std::pair(greatestSet(tighter), false)}) {
    EXPECT_NO_THROW(checker::confirmInvariant(set, certificate, problem));
    EXPECT_EQ(checker::isGreatestInvariant(set, certificate, problem), is_greatest);
  }
}

// A gain of its own for the feedback, and the delay of the controller, which the model does not have.
TEST(RobustRows, OfAFixedFeedbackHaveItsGain) {
  MadeRobust made;
  made.feedback = "fixed";
  made.horizon = 4;
  const std::string own = "feedback_gain: {Q: [3, 2, 1], R: [7]}\n";
  const std::string text = replaced(made.text(), "model:\n", own + "model:\n  delay: 0.02\n");
  const ProvenRobust proven(parseRobustProblem(text, "made.yaml"));
  ASSERT_NE(proven.proof.certificate, "");
  EXPECT_EQ(refusalOf(proven, text), "");
  EXPECT_NE(refusalOf(proven, replaced(text, own, "")), "");
  EXPECT_NE(refusalOf(proven, replaced(text, "R: [7]", "R: [7.000001]")), "");
  EXPECT_NE(refusalOf(proven, replaced(text, "{Q: [3, 2, 1], R: [7]}", "{gain: [[-0.1, -0.2, -0.3]]}")), "");
  EXPECT_NE(refusalOf(proven, replaced(text, "feedback_predictions: fixed", "feedback_predictions: free")),
            "");
}

TEST(RobustRows, OfADiscreteModelAreExact) {
  MadeRobust made;
  made.states = 2;
  made.horizon = 3;
  std::string text =
      replaced(made.text(), "A: [[0, 1], [0, -0.01]]", "time: discrete\n  A: [[1, 0.1], [0, 1]]");
  text = replaced(text, "B: [[0], [1]]", "B: [[0.005], [0.1]]");
  text = replaced(text, "G: [[0], [1]]", "G: [[0.005], [\"1/10\"]]");
  text = replaced(text, "{Q: [40, 20], R: [35]}", "{gain: [[-0.8, -1.2]]}");
  const ProvenRobust proven(parseRobustProblem(text, "discrete.yaml"));
  EXPECT_EQ(matchOf(proven.proof.certificate, proven.content, text).difference, 0);
  EXPECT_NE(refusalOf(proven, replaced(text, "0.005", "0.00500000000000001")), "");
  EXPECT_NE(refusalOf(proven, replaced(text, "-1.2", "-1.20000000000001")), "");
}

TEST(RobustRows, AnotherProblemIsRefused) {
  const std::string text = withReferences().text();
  ASSERT_EQ(refusalOf(referenceProof(), text), "");
  const std::vector<std::pair<std::string, std::string>> changes = {
      {"-0.01, 9.81", "-0.0100001, 9.81"},
      {"[4.5]", "[4.50001]"},
      {"[0, 1]]", "[0, 1.00001]]"},
      {"C: [[1, 0, 0]]", "C: [[1, 1e-9, 0]]"},
      {"range: [-0.5, 0.5]", "range: [-0.4, 0.5]"},
      {"range: [-0.5, 0.5]", "range: [-0.4, 0.4]"},
      {"range: [-0.1, 0.2]", "range: [-0.1, 0.21]"},
      {"unit: rad, range: [-0.35, 0.35]}\n  inputs", "unit: rad, range: [-0.35, 0.36]}\n  inputs"},
      {"unit: m/s, range: [-1.5, 1.5]}\n", "unit: m/s}\n"},
      {"{name: p, unit: m}", "{name: p, unit: m, range: [-9, 9]}"},
      {"{name: u, unit: rad, range: [-0.35, 0.35]}", "{name: u, unit: rad, range: [-0.35, 0.351]}"},
      {"sampling_time: 0.08", "sampling_time: 0.0801"},
      {"horizon: 3", "horizon: 4"},
      {"horizon: 3", "horizon: 2"},
      {"stack: paper", "stack: shift"},
      {"feedback_predictions: free", "feedback_predictions: zero"},
      {"feedback_predictions: free", "feedback_predictions: fixed"},
      {"floor: 0\n", "floor: 1e-6\n"},
      {"peak_in_map: false", "peak_in_map: true"},
      {"invariance: none", "invariance: first_step"},
      {"invariance: none", "invariance: terminal"},
      {"Q: [40, 20, 10]", "Q: [40, 20, 10.0001]"},
      {"R: [35]", "R: [34.9]"},
      {"state: [0, 1, 0], input: [0]", "state: [0, 0.999, 0], input: [0]"},
      {"10/9", "11/9"},
      {"role: error, of: p, unit: m, range: [-1.5, 1.5]", "role: error, of: p, unit: m, range: [-1.5, 1.6]"},
      {"range: [-0.8, 0.8]", "range: [-0.8, 0.7]"},
      {"floor: 0\n", "floor: 0\nunknown: 1\n"},
      {"type: robust_mpc", "type: tracking_mpc"},
      {"sampling_time: 0.08", "sampling_time: .inf"},
      {"sampling_time: 0.08", "sampling_time: .nan"},
      {"{name: u, unit: rad, ", "{name: u, unit: rad, rate: [-1, 1], "},
      {"role: error, of: v", "role: error, of: p"},
  };
  for (const auto& [from, to] : changes)
    EXPECT_NE(refusalOf(referenceProof(), replaced(text, from, to)), "") << to;
}

class RobustRowMutation : public Mutation {
 protected:
  RobustRowMutation() : Mutation(Subject(referenceProof().content, referenceProof().proof.certificate)) {}

  std::string refusalWithLines(const std::vector<std::string>& lines) const {
    return refusalOf(sealed(joined(lines, "\n") + "\n", map_), referenceProof().content,
                     withReferences().text());
  }
};

/// A row of a certificate whose bound is greater by a 64th.
std::string loosened(const std::string& line) {
  const std::size_t end = line.find(' ', 4);
  const mpq_class bound = mpq_class(line.substr(4, end - 4), 16) + mpq_class(1, 64);
  return "row " + bound.get_str(16) + line.substr(end);
}

/// Each row alone that is loosened is refused. A row of references alone may be: they stay.
void expectLoosenedSetsRefused(const MadeRobust& made) {
  const ProvenRobust proven(made);
  ASSERT_NE(proven.proof.certificate, "");
  const checker::RobustMatch match = matchOf(proven.proof.certificate, proven.content, made.text());
  std::vector<std::string> lines = linesOf(proven.proof.certificate);
  std::size_t of_the_set = 0;
  for (std::string& line : lines) {
    if (line.compare(0, 4, "row ") != 0) continue;
    const std::string kept = line;
    line = loosened(kept);
    const std::string refusal =
        refusalOf(sealed(joined(lines, "\n") + "\n", bytesOf(proven.content)), proven.content, made.text());
    const bool says_nothing_of_input = kept.compare(kept.size() - 8, 8, " 0 0 0 0") == 0;
    EXPECT_TRUE(refusal != "" || says_nothing_of_input) << kept;
    if (refusal.find("invariant") != std::string::npos) ++of_the_set;
    line = kept;
  }
  EXPECT_GT(match.invariance_rows, 4u);
  EXPECT_TRUE(match.is_greatest);
  EXPECT_GE(of_the_set + 2, match.invariance_rows);
}

TEST(RobustRows, OfASetThatIsNotInvariantAreRefused) {
  MadeRobust made = withoutInvariance();
  for (const char* const rule : {"first_step", "terminal"}) {
    made.invariance = rule;
    expectLoosenedSetsRefused(made);
  }
  MadeRobust followed = withReferences();
  followed.invariance = "first_step";
  followed.torque = false;
  expectLoosenedSetsRefused(followed);
}

TEST_F(RobustRowMutation, ALoosenedOrRepeatedRowIsRefused) {
  const std::vector<std::string> lines = linesOf(certificate_);
  ASSERT_EQ(refusalWithLines(lines), "");
  int tried = 0;
  for (std::size_t k = 0; k < lines.size(); ++k) {
    if (lines[k].compare(0, 4, "row ") != 0) continue;
    ++tried;
    std::vector<std::string> loosened = lines;
    loosened[k] = "row 7fff" + lines[k].substr(lines[k].find(' ', 4));
    EXPECT_TRUE(holds(refusalWithLines(loosened), "of the problem is none of the certificate")) << lines[k];
    std::vector<std::string> repeated = lines;
    repeated.insert(repeated.begin() + static_cast<std::ptrdiff_t>(k), lines[k]);
    EXPECT_NE(refusalWithLines(repeated), "") << lines[k];
  }
  EXPECT_GT(tried, 20);
}

}  // namespace
}  // namespace polyfly
