#include "made_logs.hpp"

#include <cmath>
#include <fstream>
#include <random>

namespace polyfly {
namespace {

constexpr double kPeriod = 0.01;
constexpr int kSamples = 6000;
constexpr double kDegrees = 3.14159265358979323846 / 180.0;

// Steps that hold for half a second to a second and a half, answered by x' = (gain u - x) / tau.
struct Roll {
  std::vector<double> command;
  std::vector<double> response;
};

Roll rollFlight(double gain, double tau) {
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> level(-0.25, 0.25);
  std::uniform_int_distribution<int> hold(50, 150);
  std::normal_distribution<double> noise(0.0, 0.001);
  Roll roll;
  double x = 0.0;
  double u = 0.0;
  int left = 0;
  const double decay = std::exp(-kPeriod / tau);
  for (int sample = 0; sample < kSamples; ++sample) {
    if (left-- == 0) {
      u = level(generator);
      left = hold(generator);
    }
    roll.command.push_back(u);
    roll.response.push_back(x + noise(generator));
    x = decay * x + (1.0 - decay) * gain * u;
  }
  return roll;
}

// [us]
std::uint64_t stampOf(std::int64_t start, int sample, std::int64_t set_by) {
  const auto period = static_cast<std::int64_t>(1e6 * kPeriod);
  return static_cast<std::uint64_t>(start + period * sample + (sample < 2000 ? 0 : set_by));
}

}  // namespace

MadeULog::MadeULog() {
  bytes = {0x55, 0x4c, 0x6f, 0x67, 0x01, 0x12, 0x35, 0x01};
  put<std::uint64_t>(1000000, &bytes);
}

void MadeULog::message(char type, const std::vector<std::uint8_t>& body) {
  put<std::uint16_t>(static_cast<std::uint16_t>(body.size()), &bytes);
  bytes.push_back(static_cast<std::uint8_t>(type));
  bytes.insert(bytes.end(), body.begin(), body.end());
}

void MadeULog::flags(std::uint8_t incompatible) {
  std::vector<std::uint8_t> body(40, 0);
  body[8] = incompatible;
  message('B', body);
}

void MadeULog::format(const std::string& text) { message('F', {text.begin(), text.end()}); }

void MadeULog::subscribe(std::uint8_t instance, std::uint16_t id, const std::string& name) {
  std::vector<std::uint8_t> body = {instance};
  put(id, &body);
  body.insert(body.end(), name.begin(), name.end());
  message('A', body);
}

void MadeULog::data(std::uint16_t id, const std::vector<std::uint8_t>& row) {
  std::vector<std::uint8_t> body;
  put(id, &body);
  body.insert(body.end(), row.begin(), row.end());
  message('D', body);
}

void MadeULog::dropout(std::uint16_t milliseconds) {
  std::vector<std::uint8_t> body;
  put(milliseconds, &body);
  message('O', body);
}

MadeDataflash::MadeDataflash() { format(128, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns", 89); }

void MadeDataflash::format(std::uint8_t type, const std::string& name, const std::string& letters,
                           const std::string& columns, std::uint8_t length) {
  const auto text = [](const std::string& value, std::size_t size, std::vector<std::uint8_t>* body) {
    for (std::size_t index = 0; index < size; ++index) {
      body->push_back(index < value.size() ? static_cast<std::uint8_t>(value[index]) : 0);
    }
  };
  std::vector<std::uint8_t> body = {type, length};
  text(name, 4, &body);
  text(letters, 16, &body);
  text(columns, 64, &body);
  row(128, body);
}

void MadeDataflash::row(std::uint8_t type, const std::vector<std::uint8_t>& body) {
  bytes.insert(bytes.end(), {0xa3, 0x95, type});
  bytes.insert(bytes.end(), body.begin(), body.end());
}

MadeULog madePx4Flight(double gain, double tau, std::int64_t set_by) {
  const Roll roll = rollFlight(gain, tau);
  MadeULog log;
  log.flags(0);
  log.format("vehicle_attitude:uint64_t timestamp;float[4] q;");
  log.format(
      "vehicle_attitude_setpoint:uint64_t timestamp;float roll_body;float pitch_body;float[3] thrust_body;");
  log.subscribe(0, 1, "vehicle_attitude");
  log.subscribe(0, 2, "vehicle_attitude_setpoint");
  for (int sample = 0; sample < kSamples; ++sample) {
    const std::uint64_t stamp = stampOf(5000000, sample, set_by);
    std::vector<std::uint8_t> setpoint;
    put(stamp, &setpoint);
    put(static_cast<float>(roll.command[static_cast<std::size_t>(sample)]), &setpoint);
    for (const float rest : {0.0F, 0.0F, 0.0F, -0.5F}) put(rest, &setpoint);
    log.data(2, setpoint);
    std::vector<std::uint8_t> attitude;
    put(stamp, &attitude);
    const double half = 0.5 * roll.response[static_cast<std::size_t>(sample)];
    for (const double part : {std::cos(half), std::sin(half), 0.0, 0.0})
      put(static_cast<float>(part), &attitude);
    log.data(1, attitude);
  }
  return log;
}

MadeDataflash madeArduPilotFlight(double gain, double tau, std::int64_t set_by) {
  const Roll roll = rollFlight(gain, tau);
  MadeDataflash log;
  log.format(10, "ATT", "Qccccf", "TimeUS,DesRoll,Roll,DesPitch,Pitch,Yaw", 3 + 8 + 8 + 4);
  for (int sample = 0; sample < kSamples; ++sample) {
    std::vector<std::uint8_t> row;
    put(stampOf(7000000, sample, set_by), &row);
    for (const double angle : {roll.command[static_cast<std::size_t>(sample)],
                               roll.response[static_cast<std::size_t>(sample)], 0.0, 0.0}) {
      put(static_cast<std::int16_t>(std::lround(100.0 * angle / kDegrees)), &row);
    }
    put(90.0F, &row);
    log.row(10, row);
  }
  return log;
}

void writeBytes(const std::vector<std::uint8_t>& bytes, const std::string& path) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace polyfly
