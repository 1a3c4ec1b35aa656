// check_problem: program and safe set of a filter against the problem file, by arithmetic of its own.
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "../../test/mutation.hpp"
#include "../../test/program_matrices.hpp"
#include "made_filters.hpp"
#include "problem/filter_match.hpp"
#include "problem/polyhedron.hpp"
#include "problem/signals.hpp"
#include "safety_filter/prove_filter.hpp"
#include "safety_filter/safe_set.hpp"

namespace polyfly {
namespace {

using checker::FilterProblem;

SafetyFilterProblem withItsSet(const std::string& text) {
  const SafetyFilterProblem problem = parseSafetyFilter(text, "made.yaml");
  return parseSafetyFilter(withSafeSet(problem, computeSafeSet(problem)), "made.yaml");
}

/// Empty: program and safe set are those of the problem. Else why they are not.
std::string refusalOfFilter(const checker::Matrices& program, const FilterProblem& problem) {
  return refusalOf([&] {
    checker::matchFilter(program, problem);
    checker::confirmSafeSet(problem);
  });
}

MadeFilter uncertainFilter(double delay) {
  MadeFilter made;
  made.margin = 1e-5;
  made.disturbance = 0.3;
  made.input_error = 1e-6;
  made.error = 1e-3;
  made.delay = delay;
  made.A = "[[0, 1], [0, -0.2]]";
  return made;
}

/// Two inputs, one of which counts more; a disturbance on both states.
std::string twoInputs() {
  return R"(polyfly_problem: 1
name: two
type: safety_filter
sampling_time: 0.1
margin: 1e-4
model:
  states:
    - {name: p, unit: m, range: [-1, 2]}
    - {name: v, unit: m/s, range: [-1.5, 1.5], error: 0.01}
  inputs:
    - {name: a, unit: m/s^2, range: [-2, 3], weight: 3}
    - {name: s, unit: m/s, range: [-0.2, 0.1], wish: [-1, 1]}
  disturbances:
    - {name: w, unit: m/s^2, range: [-0.2, 0.3]}
  A: [[0, 1], [0, -0.1]]
  B: [[0, 1], [1, 0.2]]
  B_d: [[0.1], [1]]
)";
}

TEST(FilterProblemChecker, ConfirmsWhatSolveMakes) {
  std::vector<std::string> texts = {MadeFilter().text(), twoInputs()};
  for (const double delay : {0.0, 0.02, 0.05}) texts.push_back(uncertainFilter(delay).text());
  for (const std::string& text : texts) {
    const SafetyFilterProblem problem = withItsSet(text);
    EXPECT_EQ(refusalOfFilter(matricesOf(filterProgram(problem)), checker::readFilterProblem(problem.text)),
              "")
        << text;
  }
}

TEST(FilterProblemChecker, KnowsTheFileBehindACompletedText) {
  const std::string file = MadeFilter().text();
  const std::string whole = withItsSet(file).text;
  EXPECT_TRUE(checker::isCompletedText(whole, file));
  EXPECT_TRUE(checker::isCompletedText(whole, file.substr(0, file.size() - 1)));
  EXPECT_FALSE(checker::isCompletedText(file, file));
  EXPECT_FALSE(checker::isCompletedText(whole + "margin: 1\n", file));
  std::string other = file;
  other[other.find("made")] = 'f';
  EXPECT_FALSE(checker::isCompletedText(whole, other));
}

TEST(FilterProblemChecker, RefusesEachChangedNumberOfTheProgram) {
  const SafetyFilterProblem problem = withItsSet(uncertainFilter(0.02).text());
  const checker::Matrices right = matricesOf(filterProgram(problem));
  const FilterProblem read = checker::readFilterProblem(problem.text);
  for (const auto& [name, matrix] : right) {
    for (std::size_t k = 0; k < matrix.entries.size(); ++k) {
      checker::Matrices changed = right;
      mpq_class& entry = changed.at(name).entries[k];
      entry += (entry == 0 ? mpq_class(1) : entry) / 1000000000;
      EXPECT_THROW(checker::matchFilter(changed, read), checker::Refused) << name << " " << k;
    }
  }
}

/// Problems that differ by 1e-9 from the one whose program and set are right, in any field. Of errors, disturbances and margin those that
/// are greater: with smaller ones the set is as safe.
class ChangedFilters {
 public:
  explicit ChangedFilters(FilterProblem right) : right_(std::move(right)) {
    for (checker::Matrix FilterProblem::*part :
         {&FilterProblem::H, &FilterProblem::G, &FilterProblem::b, &FilterProblem::M}) {
      for (std::size_t k = 0; k < (right_.*part).entries.size(); k += 5)
        add([=](FilterProblem& problem, double change) { (problem.*part).entries[k] += change; });
    }
    for (std::size_t k = 0; k < right_.k.entries.size(); ++k)
      addGreater([=](FilterProblem& problem, double change) { problem.k.entries[k] -= change; });
    for (checker::BallMatrix FilterProblem::*part : {&FilterProblem::A, &FilterProblem::B}) {
      for (std::size_t i = 0; i < (right_.*part).rows(); ++i)
        for (std::size_t j = 0; j < (right_.*part).columns(); ++j)
          add([=](FilterProblem& problem, double change) { enlarge(problem.*part, i, j, change); });
    }
    for (std::size_t i = 0; i < right_.B_d.rows(); ++i)
      addGreater([=](FilterProblem& problem, double change) { enlarge(problem.B_d, i, 0, change); });
    for (std::vector<FilterProblem::Range> FilterProblem::*ranges :
         {&FilterProblem::states, &FilterProblem::inputs, &FilterProblem::wishes}) {
      for (std::size_t k = 0; k < (right_.*ranges).size(); ++k) {
        add([=](FilterProblem& problem, double change) { (problem.*ranges)[k].first += change; });
        add([=](FilterProblem& problem, double change) { (problem.*ranges)[k].second += change; });
      }
    }
    addGreater([](FilterProblem& problem, double change) { problem.disturbances[0].second += change; });
    addGreater([](FilterProblem& problem, double change) { problem.disturbances[0].first -= change; });
    for (std::vector<double> FilterProblem::*errors :
         {&FilterProblem::state_errors, &FilterProblem::input_errors}) {
      for (std::size_t k = 0; k < (right_.*errors).size(); ++k)
        addGreater([=](FilterProblem& problem, double change) { (problem.*errors)[k] += change; });
    }
    add([](FilterProblem& problem, double change) { problem.weights[0] += change; });
    add([](FilterProblem& problem, double change) { problem.sampling_time += change; });
    add([](FilterProblem& problem, double change) { problem.delay += change; });
    addGreater([](FilterProblem& problem, double change) { problem.margin += change; });
  }

  const std::vector<FilterProblem>& all() const { return changed_; }

 private:
  static void enlarge(checker::BallMatrix& matrix, std::size_t i, std::size_t j, double change) {
    matrix.at(i, j) += checker::Ball(mpq_class(change));
  }

  template <class Change>
  void addGreater(const Change& change) {
    changed_.push_back(right_);
    change(changed_.back(), 1e-9);
  }
  template <class Change>
  void add(const Change& change) {
    addGreater(change);
    changed_.push_back(right_);
    change(changed_.back(), -1e-9);
  }

  FilterProblem right_;
  std::vector<FilterProblem> changed_;
};

TEST(FilterProblemChecker, RefusesEachChangedNumberOfTheFile) {
  const SafetyFilterProblem problem = withItsSet(uncertainFilter(0.02).text());
  const checker::Matrices program = matricesOf(filterProgram(problem));
  const ChangedFilters changed(checker::readFilterProblem(problem.text));
  EXPECT_GT(changed.all().size(), 200u);
  for (std::size_t k = 0; k < changed.all().size(); ++k)
    EXPECT_NE(refusalOfFilter(program, changed.all()[k]), "") << k << " of " << changed.all().size();
}

/// A set of one's own, with the program that belongs to it.
std::string refusalOfSet(const FilterProblem& problem) {
  return refusalOf([&] { checker::confirmSafeSet(problem); });
}

TEST(FilterProblemChecker, RefusesSetsThatAreNotSafe) {
  const SafetyFilterProblem problem = withItsSet(uncertainFilter(0.02).text());
  const FilterProblem right = checker::readFilterProblem(problem.text);
  ASSERT_EQ(refusalOfSet(right), "");
  const auto with = [&](auto change) {
    FilterProblem changed = right;
    change(changed);
    return refusalOfSet(changed);
  };
  const auto scaled = [](checker::Matrix& matrix, double factor) {
    for (mpq_class& entry : matrix.entries) entry *= mpq_class(factor);
  };
  EXPECT_NE(with([&](FilterProblem& changed) { scaled(changed.k, -1.0); }).find("empty"), std::string::npos);
  EXPECT_NE(with([&](FilterProblem& changed) { scaled(changed.k, 2.0); }).find("within the ranges"),
            std::string::npos);
  for (std::size_t row = 0; row < right.H.rows; row += 4) {
    const auto loosen = [&](FilterProblem& changed) { changed.b.entries[row] += 1e-6; };
    EXPECT_TRUE(holds(with(loosen), "does not keep row")) << row;
    const auto tighten = [&](FilterProblem& changed) { changed.b.entries[row] -= 0.5; };
    EXPECT_NE(with(tighten), "") << row;
  }
  // No other number of this one depends on the upper end of the input's range.
  MadeFilter made = uncertainFilter(0.0);
  made.A = "[[0, 1], [0, 0]]";
  FilterProblem weak = checker::readFilterProblem(withItsSet(made.text()).text);
  ASSERT_EQ(refusalOfSet(weak), "");
  weak.inputs[0].second -= 1e-3;
  EXPECT_TRUE(holds(refusalOfSet(weak), "no admissible input"));
  EXPECT_NE(with([](FilterProblem& changed) { changed.sampling_time = 40.0; }).find("too long"),
            std::string::npos);
}

TEST(FilterProblemChecker, RefusesFilesThatItDoesNotKnow) {
  const std::string text = withItsSet(twoInputs()).text;
  const auto refusal = [&](const std::string& from, const std::string& to) {
    return refusalOf([&] { checker::readFilterProblem(replaced(text, from, to)); });
  };
  EXPECT_EQ(refusal("name: two", "name: three"), "");
  for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
           {"margin", "magrin"},
           {"weight: 3", "weight: 0"},
           {"weight: 3", "weihgt: 3"},
           {"error: 0.01", "error: -0.01"},
           {"range: [-1, 2]", "range: [2, -1]"},
           {"sampling_time: 0.1", "sampling_time: 0"},
           {"sampling_time: 0.1", "sampling_time: 0.1\ndelay: 0.2"},
           {"  B_d: [[0.1], [1]]\n", ""},
           {"  B_d: [[0.1], [1]]\n", "  B_d: [[0.1]]\n"},
           {"safe_set:", "safe:"},
           {"type: safety_filter", "type: tracking_mpc"},
           {"polyfly_problem: 1", "polyfly_problem: 2"},
           {"A: [[0, 1]", "A: [[0, .inf]"}})
    EXPECT_NE(refusal(from, to), "") << from << " " << to;
}

MapContent mapOf(const SafetyFilterProblem& problem) { return solved(filterProgram(problem)); }

/// Why answers of a map are refused.
std::string refusalOfMap(const MapContent& content, const FilterProblem& problem) {
  const checker::Map map(bytesOf(content));
  return refusalOf([&] { checker::confirmAnswers(problem, map); });
}

/// Margins between which the prover changes its mind, by vertices instead of multipliers.
TEST(FilterProblemChecker, AnswersAreThoseThatTheProofAllows) {
  int confirmed = 0;
  for (const double delay : {0.0, 0.02}) {
    for (const double margin : {1e-8, 1e-4}) {
      MadeFilter made = uncertainFilter(delay);
      made.period = 0.1;
      made.margin = margin;
      const SafetyFilterProblem problem = withItsSet(made.text());
      const MapContent content = mapOf(problem);
      const FilterAnswers proven = proveAnswers(MapInMemory(content).map(), problem);
      const std::string refusal = refusalOfMap(content, checker::readFilterProblem(problem.text));
      EXPECT_EQ(refusal.empty(), proven.hold()) << delay << " " << margin << " " << proven.used << refusal;
      confirmed += refusal.empty() ? 1 : 0;
    }
  }
  EXPECT_GT(confirmed, 0);
  EXPECT_LT(confirmed, 4);
}

TEST(FilterProblemChecker, RefusesAnswersThatNeedMoreThanTheMargin) {
  MadeFilter made = uncertainFilter(0.0);
  made.period = 0.3;
  const SafetyFilterProblem problem = withItsSet(made.text());
  const FilterProblem read = checker::readFilterProblem(problem.text);
  const MapContent right = mapOf(problem);
  ASSERT_EQ(refusalOfMap(right, read), "");
  // Far inside of the set, most regions have no state.
  FilterProblem inner = read;
  for (mpq_class& entry : inner.k.entries) entry /= 4;
  EXPECT_EQ(refusalOfMap(right, inner), "");
  const std::size_t columns = 4, laws = right.laws.size() / columns;
  for (std::size_t law = 0; law < laws; ++law) {
    const auto refused = [&](double change) {
      MapContent wrong = right;
      wrong.laws[law * columns + 3] += change;
      return !refusalOfMap(wrong, read).empty();
    };
    // One sign leads outwards. At the range of the input the actuator ends too, so neither may.
    const double* row = &right.laws[law * columns];
    const bool is_constant = row[0] == 0.0 && row[1] == 0.0 && row[2] == 0.0;
    EXPECT_TRUE(is_constant || refused(1e-3) || refused(-1e-3)) << law;
  }
  FilterProblem tight = read;
  tight.margin = 1e-12;
  EXPECT_TRUE(holds(refusalOfMap(right, tight), "needs more than the margin"));
  MapContent wrong = right;
  for (std::size_t law = 0; law < laws; ++law) {
    double& slope = wrong.laws[law * columns + 2];
    if (slope == 1.0) slope = 1.0 - 0x1p-53;
  }
  EXPECT_TRUE(holds(refusalOfMap(wrong, read), "wish comes back changed"));
}

std::string refusalOfSignals(const MapContent& content) {
  const checker::Map map(bytesOf(content));
  return refusalOf([&] { checker::matchSignals(map, map.problem); });
}

TEST(FilterProblemChecker, RefusesOtherSignals) {
  MadeFilter made = uncertainFilter(0.05);
  made.margin = 1e-4;
  made.period = 0.1;
  const SafetyFilterProblem problem = withItsSet(made.text());
  const MapContent right = mapOf(problem);
  ASSERT_EQ(refusalOfSignals(right), "");
  const auto with = [&](auto change) {
    MapContent changed = right;
    change(changed);
    return refusalOfSignals(changed);
  };
  EXPECT_NE(with([](MapContent& map) { map.parameters[2].name = "a_befor"; }).find("in the place of"),
            std::string::npos);
  EXPECT_NE(with([](MapContent& map) { map.parameters[3].unit = "m"; }).find("unit"), std::string::npos);
  // Moved as a whole, so that planes keep their length.
  const auto moved = [](MapContent& map) {
    map.parameters[3].lower += 1e-9;
    map.parameters[3].upper += 1e-9;
  };
  EXPECT_TRUE(holds(with(moved), "range"));
  EXPECT_NE(with([](MapContent& map) { map.inputs[0].lower -= 1e-9; }).find("range"), std::string::npos);
  EXPECT_NE(with([](MapContent& map) { map.period *= 2; }).find("period"), std::string::npos);
}

/// Half-spaces of polygons: a touching one holds, one that cuts off 1e-9 does not; of a halved set nothing is known.
TEST(FilterProblemChecker, MultipliersDecideExactly) {
  using checker::ExactHalfSpace;
  const std::vector<ExactHalfSpace> triangle = {{{-1, 0}, 0}, {{0, -1}, 0}, {{3, 1}, mpq_class(1, 3)}};
  const checker::Polyhedron polyhedron(triangle);
  EXPECT_TRUE(polyhedron.hasPoint());
  for (const double shift : {0.0, 1e-30}) {
    EXPECT_TRUE(polyhedron.isWithin({{1, 1}, mpq_class(1, 3) + mpq_class(shift)}));
    EXPECT_TRUE(polyhedron.isWithin({{1, 0}, mpq_class(1, 9) + mpq_class(shift)}));
  }
  for (const double shift : {1e-9, 1e-30}) {
    EXPECT_FALSE(polyhedron.isWithin({{1, 1}, mpq_class(1, 3) - mpq_class(shift)}));
    EXPECT_FALSE(polyhedron.isWithin({{-1, 0}, -mpq_class(shift)}));
  }
  EXPECT_FALSE(checker::Polyhedron({{{1, 0}, 0}, {{0, 1}, 0}}).isWithin({{-1, 0}, 1000000}));
  const checker::Polyhedron empty({{{1, 0}, 0}, {{-1, 0}, -1}});
  EXPECT_FALSE(empty.hasPoint());
  EXPECT_TRUE(empty.isEmpty());
  const checker::Polyhedron line({{{1, 0}, 0}, {{-1, 0}, 0}});
  EXPECT_TRUE(line.hasPoint());
  EXPECT_FALSE(line.isEmpty());
  const std::vector<ExactHalfSpace> shadow = checker::withoutImplied(checker::withoutEntry(triangle, 1));
  EXPECT_EQ(shadow.size(), 2u);
  EXPECT_TRUE(checker::Polyhedron(shadow).isWithin({{1, 0}, mpq_class(1, 9)}));
  EXPECT_FALSE(checker::Polyhedron(shadow).isWithin({{1, 0}, mpq_class(1, 10)}));
  EXPECT_FALSE(checker::weightsOf({{1, 2}, {2, 4}}, {1, 3}).has_value());
  EXPECT_TRUE(checker::weightsOf({{1, 2}, {2, 4}}, {3, 6}).has_value());
}

}  // namespace
}  // namespace polyfly
