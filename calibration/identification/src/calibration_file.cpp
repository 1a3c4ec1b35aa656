#include "identification/calibration_file.hpp"

namespace polyfly {

Json calibrationHead(const std::string& kind, const Json& data, const VehicleKind& vehicle) {
  return {{"polyfly_calibration", 1},
          {"kind", kind},
          {"tool_version", kIdentificationVersion},
          {"data", data},
          {"vehicle", {{"kind", vehicle.name}, {"reason", vehicle.reason}}}};
}

Json jsonOf(const std::vector<Provenance>& flights) {
  Json list = Json::array();
  for (const Provenance& flight : flights)
    list.push_back({{"file", flight.file}, {"checksum", flight.checksum}, {"recorded", flight.recorded}});
  return list.size() == 1 ? list.front() : list;
}

Json jsonOf(const std::vector<TimeWindow>& windows) {
  Json list = Json::array();
  for (const TimeWindow& window : windows) list.push_back({window.from, window.to});
  return list;
}

Report calibrationPage(const std::vector<Provenance>& flights, const std::vector<std::string>& reasons) {
  Report page;
  page.title = "Calibration report";
  for (const Provenance& flight : flights)
    page.sources.push_back(flight.file + " · " + flight.checksum +
                           (flight.recorded.empty() ? "" : " · " + flight.recorded));
  page.good = reasons.empty();
  page.verdict =
      page.good ? "The data support these numbers" : "To be looked at before these numbers are used";
  page.reasons = reasons;
  return page;
}

}  // namespace polyfly
