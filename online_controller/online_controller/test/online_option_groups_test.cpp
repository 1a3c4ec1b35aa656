// Which group of options a misspelt one stands for.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "online_controller/laws/linear_tuning.hpp"
#include "online_controller/types/flight_options.hpp"
#include "online_controller/types/option_groups.hpp"
#include "online_controller/types/options.hpp"
#include "polyfly_base/closest_name.hpp"

namespace {

const std::vector<std::string> kKnown(polyfly::kOptionGroups.begin(), polyfly::kOptionGroups.end());

std::string meant(const std::string& name) { return polyfly::closestName(name, kKnown).value_or(""); }

TEST(OptionGroups, ASlipAwayIsMeant) {
  for (const char* slip : {"vehical", "vehicl", "vehicles", "Vehicle", "vehcile", "ehicle"})
    EXPECT_EQ(meant(slip), "vehicle") << slip;
  EXPECT_EQ(meant("contoller"), "controller");
  EXPECT_EQ(meant("lineer"), "linear");
  EXPECT_EQ(meant("non_linear"), "nonlinear");
  EXPECT_EQ(meant("kf_observer"), "KF_observer");
  EXPECT_EQ(meant("map"), "maps");
  EXPECT_EQ(meant("RC"), "rc");
  EXPECT_EQ(meant("reference_limit"), "reference_limits");
}

TEST(OptionGroups, WhatIsOursOrFarFromAllIsNotMisspelt) {
  for (const std::string& name : kKnown) EXPECT_EQ(meant(name), "") << name;
  for (const char* other :
       {"adopted", "plant", "diagnostics", "compressed", "limits", "car", "odometry", "tf"})
    EXPECT_EQ(meant(other), "") << other;
}

struct InAGroup {
  template <class... Rest>
  void operator()(const char* key, const Rest&...) const {
    const std::string name = key;
    const std::string group = name.substr(0, name.find('/'));
    EXPECT_NE(std::find(kKnown.begin(), kKnown.end(), group), kKnown.end()) << key;
  }
};

TEST(OptionGroups, EveryOptionIsInOne) {
  const polyfly::MultirotorOptions options;
  const polyfly::FlightOptions flight;
  const polyfly::LinearTuning linear{};
  polyfly::visitOptions(options, InAGroup{});
  polyfly::visitFlightOptions(flight, InAGroup{});
  polyfly::visitLinearTuning(linear, InAGroup{});
}

}  // namespace
