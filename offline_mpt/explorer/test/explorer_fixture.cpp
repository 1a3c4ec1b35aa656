#include "explorer_fixture.hpp"

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <numeric>
#include <random>

#include "browser_page.hpp"

namespace polyfly {
namespace {

constexpr int kPoints = 1000;
// Of a command that the page writes with four digits.
constexpr double kShownDigits = 1e-3;

/// Moves theta onto the nearest facet of its region: there, the last bit of a sum decides which region answers.
void moveToFacet(const RegionMap& map, std::vector<double>* theta) {
  const Lookup found = map.locate(theta->data());
  if (found.status != LookupStatus::kInside) return;
  const std::size_t p = theta->size();
  const RegionView region = map.region(found.region);
  const double* nearest = nullptr;
  double least = 0.0;
  for (std::uint32_t i = 0; i < region.row_count; ++i) {
    const double* plane = map.plane(static_cast<std::size_t>(std::abs(region.rows[i])) - 1);
    const double distance = std::inner_product(plane, plane + p, theta->data(), -plane[p]);
    if (nearest != nullptr && std::abs(distance) >= std::abs(least)) continue;
    nearest = plane;
    least = distance;
  }
  if (nearest == nullptr) return;
  const double square = std::inner_product(nearest, nearest + p, nearest, 0.0);
  for (std::size_t i = 0; i < p; ++i) (*theta)[i] -= least / square * nearest[i];
}

/// The number that leads a text; U+2212 is its minus.
double shownNumber(std::string text) {
  if (text.rfind("\xe2\x88\x92", 0) == 0) text = "-" + text.substr(3);
  const std::size_t exponent = text.find("e\xe2\x88\x92");
  if (exponent != std::string::npos) text.replace(exponent, 4, "e-");
  return std::strtod(text.c_str(), nullptr);
}

}  // namespace

std::vector<std::vector<double>> pointsOf(const RegionMap& map, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> part(-1.02, 1.02);
  std::vector<std::vector<double>> points;
  for (int k = 0; k < kPoints; ++k) {
    std::vector<double> theta;
    for (const Signal& signal : map.parameters())
      theta.push_back(0.5 * (signal.lower + signal.upper) +
                      0.5 * part(random) * (signal.upper - signal.lower));
    if (k % 2 == 1) moveToFacet(map, &theta);
    points.push_back(theta);
  }
  return points;
}

ExplorerFlight asFlight(const std::vector<std::vector<double>>& points) {
  ExplorerFlight flight{"points", {}, {}};
  for (const std::vector<double>& theta : points) {
    flight.times.push_back(static_cast<double>(flight.times.size()));
    flight.thetas.insert(flight.thetas.end(), theta.begin(), theta.end());
  }
  return flight;
}

void expectSameAnswers(const RegionMap& map, const std::vector<std::vector<double>>& points,
                       const nlohmann::json& answers) {
  ASSERT_EQ(answers.size(), points.size());
  std::vector<double> u(map.inputs().size());
  std::size_t inside = 0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const nlohmann::json& answer = answers[k];
    const Lookup found = map.evaluate(points[k].data(), u.data());
    if (found.status != LookupStatus::kInside) {
      EXPECT_EQ(answer["title"], "Outside the map") << "point " << k;
      EXPECT_EQ(answer["status"],
                found.status == LookupStatus::kOutsideBox ? "outside the box" : "outside the partition");
      continue;
    }
    ++inside;
    EXPECT_EQ(answer["title"], "Region " + std::to_string(found.region)) << "point " << k;
    for (std::size_t j = 0; j < u.size(); ++j)
      EXPECT_NEAR(answer["u"][j].get<double>(), u[j], kSameSum * (1.0 + std::abs(u[j]))) << "point " << k;
    EXPECT_NEAR(shownNumber(answer["shown"]), u[0], kShownDigits * std::abs(u[0]) + kSameSum)
        << "point " << k;
  }
  EXPECT_GT(inside, points.size() / 10);
}

void Explorer::SetUp() {
  if (chromiumProgram().empty())
    GTEST_SKIP() << "no chromium in PATH: the page is not tested (apt-get install chromium)";
}

void Explorer::run(const std::string& arguments) {
  ASSERT_EQ(std::system((std::string(OFFLINE_MPT_PROGRAM) + " " + arguments + " > /dev/null").c_str()), 0)
      << arguments;
}

std::string Explorer::solve(const std::string& file) {
  run("solve " + file + " --quiet -o " + folder_.file("solved.map"));
  return folder_.file("solved.map");
}

std::string Explorer::savePage(const RegionMap& map, const ExplorerContent& content) {
  const std::string path = folder_.file("page.html");
  std::ofstream(path, std::ios::binary) << explorerPage(map, content);
  return path;
}

}  // namespace polyfly
