#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace polyfly {

/// A ULog file in memory, message by message, written from the format's description.
class MadeULog {
 public:
  MadeULog();
  void flags(std::uint8_t incompatible);
  void format(const std::string& text);  ///< "name:uint64_t timestamp;float[4] q;"
  void subscribe(std::uint8_t instance, std::uint16_t id, const std::string& name);
  void data(std::uint16_t id, const std::vector<std::uint8_t>& row);
  void dropout(std::uint16_t milliseconds);
  void message(char type, const std::vector<std::uint8_t>& body);
  std::vector<std::uint8_t> bytes;
};

/// A dataflash log in memory.
class MadeDataflash {
 public:
  MadeDataflash();
  void format(std::uint8_t type, const std::string& name, const std::string& letters,
              const std::string& columns, std::uint8_t length);
  void row(std::uint8_t type, const std::vector<std::uint8_t>& body);
  std::vector<std::uint8_t> bytes;
};

/// Appends a number as the formats have it.
template <class Number>
void put(Number number, std::vector<std::uint8_t>* row) {
  const auto* begin = reinterpret_cast<const std::uint8_t*>(&number);
  row->insert(row->end(), begin, begin + sizeof number);
}

/// Sixty seconds of roll steps answered with gain and lag, as PX4 and ArduPilot log them: forward-right-down,
/// quaternions and degrees. The clock is set by so many microseconds after the first twenty seconds.
MadeULog madePx4Flight(double gain, double tau, std::int64_t set_by = 0);
MadeDataflash madeArduPilotFlight(double gain, double tau, std::int64_t set_by = 0);

void writeBytes(const std::vector<std::uint8_t>& bytes, const std::string& path);

}  // namespace polyfly
