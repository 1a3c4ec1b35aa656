#include "validation/flight_pages.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string_view>

#include "map_explorer/explorer_page.hpp"
#include "synthetic_flight.hpp"
#include "validation/validation.hpp"

namespace polyfly {
namespace {

std::string textOf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::string encoded(const std::vector<double>& numbers) {
  return base64({reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double)});
}

class FlightPages : public testing::Test {
 protected:
  ScratchFolder folder_;
  HandMadeMaps maps_{folder_};
  FlightLog log_ = syntheticFlight(maps_.axes());
  std::vector<ReplaySample> samples_ = replay(log_, maps_.axes(), MultirotorOptions());
};

TEST_F(FlightPages, HoldTheParametersOfEachAxis) {
  samples_[7].report.axis[1].size = 0;
  writeFlightPages(samples_, maps_.axes(), "/some/where/flight <1>.bag", folder_ / "pages");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::vector<double> times, thetas;
    for (std::size_t k = 0; k < samples_.size(); ++k) {
      const AxisReport& report = samples_[k].report.axis[axis];
      if (axis == 1 && k == 7) continue;
      ASSERT_GT(report.size, 0);
      times.push_back(samples_[k].report.stamp - samples_[0].report.stamp);
      thetas.insert(thetas.end(), report.theta.begin(), report.theta.begin() + report.size);
    }
    const std::string page = textOf(folder_ / ("pages/" + flightPageNames()[axis]));
    EXPECT_NE(page.find("\"time\":\"" + encoded(times) + "\""), std::string::npos);
    EXPECT_NE(page.find("\"theta\":\"" + encoded(thetas) + "\""), std::string::npos);
    EXPECT_NE(page.find("\"source\":\"flight \\u003c1>.bag\""), std::string::npos);
  }
}

TEST_F(FlightPages, AreLinkedByTheReport) {
  const ValidationReport validation = validate(log_, samples_, maps_.axes(), MultirotorOptions());
  writeFlightPages(samples_, maps_.axes(), "flight.bag", folder_ / "all pages");
  const std::vector<ReportLink> links =
      flightPageLinks(maps_.axes(), folder_ / "all pages", folder_ / "report");
  writeReport({log_, samples_, maps_.axes(), MultirotorOptions(), validation, links}, folder_ / "report");
  const std::string report = textOf(folder_ / "report/index.html");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(links[axis].address, "../all%20pages/" + flightPageNames()[axis]);
    EXPECT_NE(report.find("<a href='" + links[axis].address + "'>" + links[axis].text + "</a>"),
              std::string::npos);
  }
  EXPECT_EQ(flightPageLinks(maps_.axes(), folder_ / "report", folder_ / "report")[0].address,
            "explore_longitudinal.html");
}

}  // namespace
}  // namespace polyfly
