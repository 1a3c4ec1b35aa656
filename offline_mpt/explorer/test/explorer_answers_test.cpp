#include <fstream>
#include <iomanip>

#include "browser_page.hpp"
#include "explorer_fixture.hpp"
#include "project_root.hpp"
#include "synthetic_map.hpp"

namespace polyfly {
namespace {

using Json = nlohmann::json;

class ExplorerAnswers : public Explorer {
 protected:
  void expectAnswersOfEval(const std::string& map_path) {
    const RegionMap map = RegionMap::open(map_path);
    const std::vector<std::vector<double>> points = pointsOf(map, 5);
    std::ofstream samples(folder_.file("samples.csv"));
    samples << std::setprecision(17);
    for (std::size_t k = 0; k < points.size(); ++k) {
      samples << k;
      for (const double value : points[k]) samples << "," << value;
      samples << "\n";
    }
    samples.close();
    run("explore " + map_path + " --samples " + folder_.file("samples.csv") + " -o " +
        folder_.file("page.html"));
    const Json report = reportOf(folder_.file("page.html"));
    expectSameAnswers(map, points, report["answers"]);
    expectVisits(map, points, report);
  }

  void expectVisits(const RegionMap& map, const std::vector<std::vector<double>>& points,
                    const Json& report) {
    std::vector<int> visits(map.regionCount());
    std::size_t outside = 0;
    for (const std::vector<double>& theta : points) {
      const Lookup found = map.locate(theta.data());
      if (found.status == LookupStatus::kInside) {
        ++visits[found.region];
      } else {
        ++outside;
      }
    }
    EXPECT_EQ(report["visited"].get<std::vector<int>>(), visits);
    std::size_t told = 0;
    for (const Json& excursion : report["excursions"])
      told += excursion["last"].get<std::size_t>() - excursion["first"].get<std::size_t>() + 1;
    EXPECT_EQ(told, outside);
  }
};

TEST_F(ExplorerAnswers, EqualEvalOfATrackingMapWithFiveParameters) {
  expectAnswersOfEval(solve(problemFile("multirotor_lateral.yaml")));
}

TEST_F(ExplorerAnswers, EqualEvalOfATrackingMapWithFourParameters) {
  expectAnswersOfEval(solve(problemFile("multirotor_vertical.yaml")));
}

TEST_F(ExplorerAnswers, EqualEvalOfTheReferenceMap) {
  expectAnswersOfEval(solve(problemFile("reference/lateral_asl.yaml")));
}

TEST_F(ExplorerAnswers, EqualEvalOfARobustMap) {
  expectAnswersOfEval(solve(problemFile("robust/aslquad_vertical.yaml")));
}

TEST_F(ExplorerAnswers, EqualEvalOfAReducedMap) {
  const std::string reduced = folder_.file("reduced.map");
  run("reduce " + solve(problemFile("multirotor_vertical.yaml")) + " --quiet -o " + reduced);
  expectAnswersOfEval(reduced);
}

TEST_F(ExplorerAnswers, EqualLookUpsOfMapsOfOneParameterOfEightAndOfTenThousandRegions) {
  struct Case {
    std::uint32_t parameters, regions;
  };
  for (const auto& [parameters, regions] :
       {Case{1, 12}, Case{2, 1}, Case{8, 200}, Case{9, 60}, Case{3, 10000}}) {
    TreeRecipe recipe;
    recipe.parameters = parameters;
    recipe.regions = regions;
    recipe.holes_one_in = regions > 1 ? 9 : 0;
    recipe.names_tests = parameters % 2 == 1;
    recipe.leaf_regions = 3;
    const MadeMap made(makeTreeMap(recipe));
    ExplorerContent content = explorerContent(made.map);
    const std::vector<std::vector<double>> points = pointsOf(made.map, parameters);
    content.flight = asFlight(points);
    const Json report = reportOf(savePage(made.map, content));
    expectSameAnswers(made.map, points, report["answers"]);
    EXPECT_FALSE(report["slice"].empty()) << parameters << " parameters";
  }
}

TEST_F(ExplorerAnswers, EqualLookUpsOfAMapOfTheFirstVersion) {
  const MapContent content = makeTreeMap({});
  AlignedBytes bytes(layOutVersion1(content));
  const RegionMap map = RegionMap::view(bytes.data(), bytes.size(), "version 1");
  ExplorerContent shown = explorerContent(map);
  const std::vector<std::vector<double>> points = pointsOf(map, 1);
  shown.flight = asFlight(points);
  expectSameAnswers(map, points, reportOf(savePage(map, shown))["answers"]);
}

}  // namespace
}  // namespace polyfly
