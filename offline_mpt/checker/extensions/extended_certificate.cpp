#include "extensions/extended_certificate.hpp"

#include <algorithm>
#include <iterator>
#include <sstream>

#include "extensions/extended_lookups.hpp"
#include "extensions/read_certificate.hpp"

namespace checker {
namespace {

// How lines of extensions begin.
const char* const kOfExtensions[] = {
    "dropped ",           "implied ",    "weights ",   "left_out ",      "dropped_follows ", "tolerated ",
    "tolerated_follows ", "convexity l", "coverage w", "sliver_region ", "sliver_cover "};

// 2^kGreatestWeight is the greatest weight of a variable. Doubles span no more.
constexpr std::size_t kGreatestWeight = 8192;

}  // namespace

bool isOfExtension(const std::string& line) {
  return std::any_of(std::begin(kOfExtensions), std::end(kOfExtensions),
                     [&](const std::string& start) { return line.compare(0, start.size(), start) == 0; });
}

std::unique_ptr<Certificate> readCertificate(const std::string& text, const Map& map) {
  std::istringstream lines(text);
  bool is_extended = false;
  for (std::string line; !is_extended && std::getline(lines, line);) is_extended = isOfExtension(line);
  std::unique_ptr<Certificate> certificate;
  if (is_extended)
    certificate = std::make_unique<ExtendedCertificate>(map);
  else
    certificate = std::make_unique<Certificate>(map);
  certificate->read(text);
  return certificate;
}

bool ExtendedCertificate::readFurther(const std::string& key, Line& line) {
  if (!isOfExtension(key + " ")) return false;
  if (key == "dropped") {
    require(dropped_.empty(), key + " is given twice");
    for (std::size_t k = line.count(kMany); k > 0; --k) dropped_.insert(line.count(kMany));
    return true;
  }
  if (key == "weights") {
    require(weights_.empty(), "weights is given twice");
    for (std::size_t k = line.count(kMany); k > 0; --k) weights_.push_back(line.count(kGreatestWeight));
    return true;
  }
  if (key == "implied") {
    implied_.push_back(readWeights(line));
    return true;
  }
  if (key == "sliver_region") {
    require(claims_.size() >= map().regions.size(), "a sliver before the last region");
    claims_.emplace_back();
  }
  lastClaim(key);
  further_.resize(claims_.size());
  FurtherClaim& claim = further_.back();
  const bool is_sliver = isSliver(claims_.size() - 1);
  if (key == "sliver_region") {
    for (std::size_t k = line.count(kMany); k > 0; --k) claim.active.push_back(line.count(kMany));
  } else if (key == "sliver_cover") {
    require(is_sliver && claim.cover.empty(), "a cover of what is no sliver");
    claim.cover = line.rest();
  } else if (key == "tolerated") {
    claim.tolerated.insert(line.word());
  } else {
    readFollows(key, line);
  }
  return true;
}

ProvenRegion ExtendedCertificate::checkRegion(std::size_t index, const Region& region) const {
  if (isSliver(index)) {
    ProvenRegion proven = proveFacets(index, region);
    proven.covered_by = checkSliver(index, region);
    return proven;
  }
  ProvenRegion proven = Certificate::checkRegion(index, region);
  if (isWidened()) proven.facets.resize(region.own);
  return proven;
}

void ExtendedCertificate::checkLookups(const std::vector<ProvenRegion>& regions) const {
  const auto listed = [this](std::size_t region) {
    require(further(region).tolerated.empty(), "a walk starts where conditions hold up to rounding only");
    return checkedRegion(region).listed;
  };
  const auto moved = [this](std::size_t region) { return movedRows(checkedRegion(region)); };
  const auto covering = [this, &moved](std::size_t region) {
    return isWidened() ? moved(region) : checkedRegion(region).listed;
  };
  ExtendedLookups lookups(map(), plane_tolerance_, regions, covering);
  lookups.extend({listed, moved, isWidened()});
  lookups.check(lookups_, progress);
}

void ExtendedCertificate::requireKinds(const std::string& convexity, const std::string& coverage) const {
  require(convexity == "definite" || convexity == "linear", "convexity: " + convexity);
  require(coverage == "exact" || coverage == "widened", "coverage: " + coverage);
}

void ExtendedCertificate::requireCount(std::size_t claims) const {
  const std::size_t regions = map().regions.size();
  require(claims >= regions && regions > 0, "regions are missing");
  require(!isWidened() || claims == regions, "slivers beside regions that are moved outwards");
}

std::string ExtendedCertificate::conditions() const {
  std::string text = Certificate::conditions();
  const auto add = [&](std::size_t count, const std::string& what) {
    if (count > 0) text += std::to_string(count) + " " + what + "\n";
  };
  add(claims_.size() - map().regions.size(),
      "slivers are left to the regions about them, within the same distance");
  if (isWidened()) text += "coverage is that of the regions moved outwards by that distance\n";
  std::size_t tolerated = 0;
  for (const FurtherClaim& claim : further_) tolerated += claim.tolerated.size();
  add(tolerated, "rows hold in a region within 2^-40 of their size only");
  if (isLinear()) text += "linear program: of several optima the shortest\n";
  const auto is_equality = [this](std::size_t row) { return equalities_.count(row) > 0; };
  const auto near = static_cast<std::size_t>(std::count_if(dropped_.begin(), dropped_.end(), is_equality));
  add(near, "equalities hold within 2^-40 of their size only");
  add(dropped_.size() - near, "rows hold within 2^-30 of their size only");
  return text;
}

}  // namespace checker
