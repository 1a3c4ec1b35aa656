#include "validation/flight_pages.hpp"

#include <cctype>
#include <cstdio>
#include <filesystem>

#include "explorer_content/explorer_content.hpp"
#include "polyfly_base/outputs.hpp"
#include "polyfly_base/write_file.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {
namespace {

ExplorerFlight flightOf(const std::vector<ReplaySample>& samples, std::size_t axis,
                        const std::string& source) {
  ExplorerFlight flight;
  flight.source = source;
  for (const ReplaySample& sample : samples) {
    const AxisReport& report = sample.report.axis[axis];
    if (report.size == 0) continue;
    flight.times.push_back(sample.report.stamp - samples.front().report.stamp);
    flight.thetas.insert(flight.thetas.end(), report.theta.begin(), report.theta.begin() + report.size);
  }
  return flight;
}

/// A path as a link: what has a meaning in an address is written as %XX.
std::string linkText(const std::string& path) {
  std::string text;
  for (const char letter : path) {
    const auto byte = static_cast<unsigned char>(letter);
    if (std::isalnum(byte) != 0 || letter == '/' || letter == '.' || letter == '_' || letter == '-') {
      text += letter;
    } else {
      char escape[4];
      std::snprintf(escape, sizeof escape, "%%%02X", static_cast<unsigned>(byte));
      text += escape;
    }
  }
  return text;
}

}  // namespace

std::array<std::string, 3> flightPageNames() {
  return {"explore_longitudinal.html", "explore_lateral.html", "explore_vertical.html"};
}

void writeFlightPages(const std::vector<ReplaySample>& samples, const AxisMaps& maps,
                      const std::string& source, const std::string& folder) {
  makeFolder(folder);
  const std::array<std::string, 3> names = flightPageNames();
  for (std::size_t axis = 0; axis < maps.size(); ++axis) {
    ExplorerContent content = explorerContent(*maps[axis]);
    content.flight = flightOf(samples, axis, std::filesystem::path(source).filename().string());
    writeFileAtomically(folder + "/" + names[axis], explorerPage(*maps[axis], content));
  }
}

std::vector<ReportLink> flightPageLinks(const AxisMaps& maps, const std::string& folder,
                                        const std::string& report_folder) {
  std::vector<ReportLink> links;
  const std::array<std::string, 3> names = flightPageNames();
  for (std::size_t axis = 0; axis < maps.size(); ++axis) {
    const std::filesystem::path page = std::filesystem::weakly_canonical(folder) / names[axis];
    const std::filesystem::path link =
        page.lexically_relative(std::filesystem::weakly_canonical(report_folder));
    links.push_back({std::string(maps[axis]->name()), linkText(link.string())});
  }
  return links;
}

}  // namespace polyfly
