#include "identification/model_support.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "identification/identify_axis.hpp"
#include "made_flight.hpp"

namespace polyfly {
namespace {

std::vector<LoopSegment> segmentsOf(const test::MadeLoop& made, std::uint32_t seed) {
  return cutSegments(test::makeFlight(made, seed), {{0.0, made.duration}}, FitOptions().delay_greatest);
}

AxisModel identified(const LoopRecord& record, bool second_order = false) {
  AxisRecords records;
  records.axis = "roll";
  records.unit = records.command_unit = "rad";
  records.training = record;
  IdentifyOptions options;
  options.windows = {{0.0, 60.0}};
  options.second_order = second_order;
  return identifyAxis(records, options);
}

std::string all(const ControllerModel& model) {
  std::string text;
  for (const std::string& sentence : model.reasons) text += sentence + "\n";
  return text;
}

// Fit in percent by its definition, from the predicted responses.
double percentOf(const std::vector<LoopSegment>& segments,
                 const std::vector<std::vector<double>>& prediction) {
  double sum = 0.0;
  double count = 0.0;
  for (const LoopSegment& segment : segments) {
    sum += std::accumulate(segment.response.begin(), segment.response.end(), 0.0);
    count += static_cast<double>(segment.response.size());
  }
  double error = 0.0;
  double spread = 0.0;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    for (std::size_t k = 0; k < segments[i].response.size(); ++k) {
      error += std::pow(segments[i].response[k] - prediction[i][k], 2);
      spread += std::pow(segments[i].response[k] - sum / count, 2);
    }
  }
  return 100.0 * (1.0 - std::sqrt(error / spread));
}

TEST(EquivalentLag, HasTheSumOfLagAndDelayWithIntervalsThatHoldIt) {
  test::MadeLoop made;
  made.coloured_noise = 0.01;
  int held = 0;
  constexpr int kFlights = 40;
  for (std::uint32_t seed = 1; seed <= kFlights; ++seed) {
    const std::vector<LoopSegment> segments = segmentsOf(made, seed);
    const LoopFit fit = fitLoop(segments, {});
    const LoopFit lag = equivalentLag(fit, segments);
    EXPECT_EQ(lag.shape.delay, 0.0);
    EXPECT_EQ(lag.find("delay"), nullptr);
    EXPECT_DOUBLE_EQ(lag.find("tau")->value, fit.shape.tau + fit.shape.delay);
    EXPECT_EQ(lag.find("gain")->value, fit.gain);
    // The errors of lag and delay offset each other.
    EXPECT_LT(lag.find("tau")->half_width, fit.find("tau")->half_width + fit.find("delay")->half_width);
    const FittedParameter& tau = *lag.find("tau");
    held += tau.least() <= made.tau + made.delay && made.tau + made.delay <= tau.greatest() ? 1 : 0;
  }
  // 34 of 40 are the lower 5 % quantile of a coverage of 91 %.
  EXPECT_GE(held, 34);
}

TEST(EquivalentLag, ItsFitIsThatOfTheLagAlone) {
  const std::vector<LoopSegment> segments = segmentsOf({}, 1);
  const LoopFit fit = fitLoop(segments, {});
  const LoopFit lag = equivalentLag(fit, segments);
  EXPECT_NEAR(lag.fit_percent, percentOf(segments, lag.prediction), 1e-9);
  EXPECT_LT(lag.fit_percent, fit.fit_percent - 5.0);
}

TEST(EquivalentLag, OfALoopWithoutDelayIsTheLoop) {
  test::MadeLoop made;
  made.delay = 0.0;
  const std::vector<LoopSegment> segments = segmentsOf(made, 2);
  const LoopFit lag = equivalentLag(fitLoop(segments, {}), segments);
  EXPECT_NEAR(lag.shape.tau, made.tau, 0.01);
  EXPECT_TRUE(std::isfinite(lag.find("tau")->half_width));
  EXPECT_GT(lag.find("tau")->half_width, 0.0);
}

TEST(IdentifyAxis, EveryControllerModelHasItsOwnEvaluation) {
  const AxisModel model = identified(test::makeFlight({}, 1), true);
  ASSERT_EQ(model.controller_models.size(), 4u);
  for (const ControllerModel& one : model.controller_models) {
    EXPECT_NEAR(one.fit.fit_percent, percentOf(model.segments, one.fit.prediction), 1e-9) << one.key;
    ASSERT_TRUE(one.validation) << one.key;
    EXPECT_NEAR(one.validation->validation_percent,
                percentOf(one.validation->segments, one.validation->prediction), 1e-9)
        << one.key;
  }
  EXPECT_TRUE(model.findModel("model")->supported()) << all(*model.findModel("model"));
  EXPECT_TRUE(model.findModel("model_without_delay")->supported())
      << all(*model.findModel("model_without_delay"));
  EXPECT_TRUE(model.supported);
  const ControllerModel& second = *model.findModel("model_second_order_without_delay");
  EXPECT_EQ(second.fit.shape.delay, 0.0);
  EXPECT_EQ(model.findModel("nothing"), nullptr);
}

// In the second half the loop goes against its command, as after a change that nobody noted.
TEST(IdentifyAxis, APoorValidationIsNoSupport) {
  LoopRecord record = test::makeFlight({}, 1);
  for (std::size_t i = 0; i < record.response.time.size(); ++i) {
    if (record.response.time[i] > 20.0) record.response.value[i] *= -0.3;
  }
  const AxisModel model = identified(record);
  EXPECT_FALSE(model.supported);
  EXPECT_NE(all(*model.findModel("model_without_delay")).find("on data that it was not fitted to"),
            std::string::npos)
      << all(*model.findModel("model_without_delay"));
}

// A delay that is long beside the lag: the loop is identified, but no lag alone describes it.
TEST(IdentifyAxis, ALagForALongDelayIsJudgedAsTheLag) {
  test::MadeLoop made;
  made.tau = 0.03;
  made.delay = 0.45;
  const AxisModel model = identified(test::makeFlight(made, 3));
  EXPECT_TRUE(model.findModel("model")->supported()) << all(*model.findModel("model"));
  EXPECT_FALSE(model.findModel("model_without_delay")->supported());
  EXPECT_FALSE(model.supported);
}

class ReasonsAgainst : public testing::Test {
 protected:
  ReasonsAgainst() {
    sound_.key = "model";
    sound_.fit = fitLoop(segments_, {});
    sound_.validation.emplace();
    sound_.validation->validation_percent = 90.0;
  }
  FittedParameter& parameter(ControllerModel* model, const std::string& name) {
    return *const_cast<FittedParameter*>(model->fit.find(name));
  }
  std::string reasonOf(const ControllerModel& model, const std::string& axis = "roll") {
    const std::vector<std::string> reasons = reasonsAgainst(model, axis, {});
    return reasons.empty() ? "" : reasons.front();
  }

  std::vector<LoopSegment> segments_ = segmentsOf({}, 1);
  ControllerModel sound_;
};

// What is handed out is the interval: of several flights it may be much wider than the standard error says.
TEST_F(ReasonsAgainst, JudgeTheIntervalThatIsHandedOut) {
  ControllerModel model = sound_;
  FittedParameter& gain = parameter(&model, "gain");
  gain.value = model.fit.gain = 1.025;
  gain.half_width = 0.755;
  EXPECT_EQ(reasonOf(model).find(
                "Too little excitation for gain, or flights that differ: its 95 % interval, 0.27 .. 1.78"),
            0u)
      << reasonOf(model);
}

// Stamps of the response that are early, or of the command that are late: a controller would be promised a quicker loop.
TEST(IdentifyAxis, AResponseThatLeadsItsCommandIsNoSupport) {
  test::MadeLoop made;
  made.gain = 0.97;
  made.tau = 0.14;
  made.delay = 0.02;
  LoopRecord record = test::makeFlight(made, 4);
  EXPECT_TRUE(identified(record).supported);
  for (double& time : record.command.time) time += 0.1;
  const AxisModel model = identified(record, true);
  EXPECT_NEAR(model.lead, 0.08, 0.02);
  for (const ControllerModel& one : model.controller_models)
    EXPECT_NE(all(one).find("before its command"), std::string::npos) << one.key;
}

TEST_F(ReasonsAgainst, AreNoneOfASoundModel) { EXPECT_EQ(reasonOf(sound_), ""); }

TEST_F(ReasonsAgainst, NameEachBar) {
  ControllerModel model = sound_;
  model.fit.fit_percent = kLeastFit - 0.1;
  EXPECT_EQ(reasonOf(model), "The fit is 59.9 %; a controller needs at least 60 %.");
  model = sound_;
  model.validation->validation_percent = 31.0;
  EXPECT_EQ(reasonOf(model),
            "The fit on data that it was not fitted to is 31.0 %; a controller needs at least 50 %.");
  model.validation.reset();
  EXPECT_EQ(reasonOf(model).find("The data do not suffice for a validation"), 0u);
  model = sound_;
  parameter(&model, "tau").half_width = 2.0 * parameter(&model, "tau").value;
  EXPECT_EQ(reasonOf(model).find("The 95 % interval of tau,"), 0u) << reasonOf(model);
  model = sound_;
  parameter(&model, "tau").half_width = NAN;
  EXPECT_EQ(reasonOf(model).find("The 95 % interval of tau,"), 0u) << reasonOf(model);
  model = sound_;
  parameter(&model, "gain").half_width = 0.17;
  EXPECT_EQ(reasonOf(model).find("Too little excitation for gain"), 0u) << reasonOf(model);
  model = sound_;
  model.fit.gain = 57.3;
  EXPECT_EQ(reasonOf(model).find("The gain of 57.3 is that of other units"), 0u) << reasonOf(model);
  EXPECT_EQ(reasonOf(model, "thrust"), "");
  model = sound_;
  model.fit.shape.tau = FitOptions().tau_greatest;
  EXPECT_EQ(reasonOf(model), "The time constant of 3.000 s lies at the end of its search range.");
  model = sound_;
  model.fit.shape.delay = FitOptions().delay_greatest;
  EXPECT_EQ(reasonOf(model), "The delay of 0.60 s lies at the end of its search range.");
}

}  // namespace
}  // namespace polyfly
