#include "online_laws.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "mpc_core/mpc_problem.hpp"
#include "online_controller/laws/multirotor_controller.hpp"
#include "online_controller/laws/nonlinear_controller.hpp"
#include "online_timing.hpp"
#include "polyfly_test/law_flight.hpp"

namespace polyfly_bench {
namespace {

using namespace polyfly;

struct Flight {
  Times step, prepare, whole;
  // Root mean square position error [m].
  double rms = 0.0;
  // Greatest position error in the last 5 s [m].
  double greatest = 0.0;
};

struct Course {
  FigureOptions figure;
  PlantOptions plant;
};

template <class Work>
void record(Times& times, const Work& work) {
  times.add(timeBatches(1, 1, work));
}

Flight fly(ControlLaw& law, const Course& course) {
  const FlightFigure figure(course.figure);
  LawFlight flown(figure, course.plant, law);
  Flight flight;
  double sum = 0.0;
  while (!flown.over()) {
    flown.measure();
    record(flight.step, [&] { law.step(flown.state(), flown.preview()); });
    const AttitudeCommand command = law.report().command;
    record(flight.prepare, [&] { law.prepare(); });
    flight.whole.wall.push_back(flight.step.wall.back() + flight.prepare.wall.back());
    flight.whole.cpu.push_back(flight.step.cpu.back() + flight.prepare.cpu.back());
    flown.advance(command);
    const double error = flown.error();
    sum += error * error;
    if (flown.time() > figure.duration() - 5.0) flight.greatest = std::max(flight.greatest, error);
  }
  flight.rms = std::sqrt(sum / static_cast<double>(flight.step.wall.size()));
  return flight;
}

Course gusty() {
  Course course;
  course.figure.rate = 0.8;
  course.plant.gust_sigma = {0.3, 0.3, 0.1};
  course.plant.position_noise = 0.003;
  course.plant.velocity_noise = 0.01;
  course.plant.attitude_noise = 0.003;
  return course;
}

void measureTimes(ControlLaw& linear, ControlLaw& nonlinear) {
  const Flight online = fly(linear, gusty());
  printTimes(online.step, {"linear law: step, three axes, N 20", 0.0, "us", 0.0, "", 0.0});
  const Flight flight = fly(nonlinear, gusty());
  printTimes(flight.whole, {"nonlinear law: whole iteration, N 20", 0.0, "us", 70.0,
                            "ACADO as shipped, as recorded", 143.0});
  printTimes(flight.step, {"nonlinear law: odometry to command, N 20", 0.0, "us", 12.0,
                           "ACADO as shipped, feedback alone, as recorded", 28.0});
}

void measureTracking(ControlLaw& linear, ControlLaw& nonlinear) {
  for (const double rate : {0.53, 0.9}) {
    Course course;
    course.figure.rate = rate;
    linear.forget(LawMemory::kAll);
    nonlinear.forget(LawMemory::kAll);
    const double by_linear = fly(linear, course).rms;
    const double by_nonlinear = fly(nonlinear, course).rms;
    const std::string name = rate < 0.6 ? "figure" : "aggressive figure";
    printRow({name + ": position error of linear, RMS", by_linear, "m", 0.0, "", 0.0});
    printRow({name + ": position error of nonlinear, RMS", by_nonlinear, "m", 0.0, "", 0.0});
    printRow(
        {name + ": nonlinear over linear", by_nonlinear / by_linear, "", rate < 0.6 ? 1.0 : 0.7, "", 0.0});
  }
  Course wind;
  wind.figure.settle_time = 1.0;
  wind.figure.radius_x = wind.figure.radius_y = wind.figure.radius_z = 0.0;
  wind.plant.wind = {3.0 / wind.plant.mass, 0.0, 0.0};
  linear.forget(LawMemory::kAll);
  nonlinear.forget(LawMemory::kAll);
  printRow({"3 N of wind: steady error of linear", fly(linear, wind).greatest, "m", 0.01, "", 0.0});
  printRow({"3 N of wind: steady error of nonlinear", fly(nonlinear, wind).greatest, "m", 0.01, "", 0.0});
}

}  // namespace

void measureLaws(const std::string& problems) {
  const std::array<MpcProblem, 3> axes{loadProblem(problems + "/multirotor_longitudinal.yaml"),
                                       loadProblem(problems + "/multirotor_lateral.yaml"),
                                       loadProblem(problems + "/multirotor_vertical.yaml")};
  MultirotorController linear(axes, MultirotorOptions{});
  NonlinearController nonlinear(MultirotorOptions{}, NonlinearMpcOptions{});
  measureTimes(linear, nonlinear);
  measureTracking(linear, nonlinear);
}

}  // namespace polyfly_bench
