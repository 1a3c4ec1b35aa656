// libFuzzer target: any bytes are read to their end or refused, as a ULog and as a dataflash log.

#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <string>

#include "autopilot/autopilot_log.hpp"
#include "polyfly_base/error.hpp"

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const int file = memfd_create("log", 0);
  if (file < 0 || write(file, data, size) != static_cast<ssize_t>(size)) __builtin_trap();
  const std::string path = "/proc/self/fd/" + std::to_string(file);
  for (const bool ulog : {true, false}) {
    try {
      const polyfly::AutopilotLog log = ulog ? polyfly::readULog(path) : polyfly::readDataflash(path);
      for (const auto& [name, table] : log.tables) {
        for (const auto& [field, column] : table.column) {
          if (column.size() != table.time.size()) __builtin_trap();
        }
      }
    } catch (const polyfly::Error&) {
      // Refused.
    }
  }
  close(file);
  return 0;
}
