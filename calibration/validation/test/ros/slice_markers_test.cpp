#include "validation_ros/slice_markers.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "synthetic_flight.hpp"

namespace polyfly_ros {
namespace {

using polyfly::SyntheticFlight;
using visualization_msgs::Marker;

class SliceMarkers : public testing::Test {
 protected:
  SliceMarkers() {
    polyfly::FlightRecorder recorder(maps_.axes(), {});
    recorder.hold(SyntheticFlight::home());
    for (std::size_t sample = 0; sample < 300; ++sample) recorder.fly(SyntheticFlight::state(sample));
    samples_ = polyfly::replay(recorder.log(), maps_.axes(), {});
  }

  polyfly::ScratchFolder folder_;
  polyfly::HandMadeMaps maps_{folder_};
  std::vector<polyfly::ReplaySample> samples_;
};

TEST_F(SliceMarkers, regionsAndSamplesLieInSquaresBesideEachOther) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double middle = 2.6 * (static_cast<double>(axis) - 1.0);
    const std::vector<Marker> markers = sliceMarkers(samples_, *maps_.axes()[axis], axis);
    ASSERT_EQ(markers.size(), 3u);
    for (const Marker& marker : {markers[0], markers[1]}) {
      for (const geometry_msgs::Point& point : marker.points) {
        EXPECT_LE(std::abs(point.x - middle), 1.0 + 1e-12);
        EXPECT_LE(std::abs(point.y), 1.0 + 1e-12);
      }
    }
    // Two rectangles of four edges.
    EXPECT_EQ(markers[0].type, int{Marker::LINE_LIST});
    EXPECT_EQ(markers[0].points.size(), 16u);
    EXPECT_NE(markers[2].text.find("up e_v_"), std::string::npos) << markers[2].text;
  }
}

TEST_F(SliceMarkers, eachSampleStandsWhereItsErrorsAre) {
  constexpr std::size_t kAxis = 1;
  const polyfly::RegionMap& map = *maps_.axes()[kAxis];
  const std::vector<Marker> markers = sliceMarkers(samples_, map, kAxis);
  ASSERT_EQ(markers[1].points.size(), samples_.size());
  ASSERT_EQ(markers[1].colors.size(), samples_.size());
  const polyfly::Signal& error = map.parameters()[0];
  ASSERT_EQ(error.name, "e_p_y");
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const double across = samples_[i].report.axis[kAxis].theta[0];
    EXPECT_NEAR(error.lower + 0.5 * (markers[1].points[i].x + 1.0) * (error.upper - error.lower), across,
                1e-9);
    EXPECT_GT(markers[1].colors[i].g, markers[1].colors[i].r);
  }
}

TEST_F(SliceMarkers, aSampleOutsideTheMapIsRed) {
  constexpr std::size_t kAxis = 2;
  samples_[7].report.axis[kAxis].lookup = polyfly::LookupStatus::kOutsideBox;
  const std::vector<Marker> markers = sliceMarkers(samples_, *maps_.axes()[kAxis], kAxis);
  EXPECT_GT(markers[1].colors[7].r, markers[1].colors[7].g);
}

}  // namespace
}  // namespace polyfly_ros

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
