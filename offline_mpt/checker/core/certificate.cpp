// Reading a certificate, and the order of its statements.
#include "core/certificate.hpp"

#include <algorithm>
#include <cstdio>
#include <sstream>

#include "checksum.hpp"

namespace checker {
namespace {

// Lines that every certificate has once, beside the program's numbers.
const char* const kHead[] = {"map",   "problem",   "tolerances", "equalities",
                             "basis", "convexity", "coverage",   "regions"};
// Lines about look-ups, which are read after all others.
const char* const kOfLookups[] = {"drop", "leaf", "outside", "near", "beyond", "sliver"};

}  // namespace

Certificate::Certificate(const Map& map) : scaling_(map), map_(map) {}

void Certificate::read(const std::string& text) {
  std::istringstream lines(unsealed(text));
  std::string content;
  require(std::getline(lines, content) && content == title(),
          std::string("the first line is not '") + title() + "'");
  claims_.reserve(map_.regions.size());
  while (std::getline(lines, content)) {
    Line line(content);
    const std::string key = line.word();
    if (contains(kOfLookups, key)) {
      lookups_.push_back(content);
      continue;
    }
    if (!readHead(key, line) && !readRegion(key, line) && !readFurther(key, line))
      require(data_.emplace(key, readMatrix(line, key)).second, key + " is given twice");
    line.end();
  }
  complete();
  checkHead();
  checkSizes();
  finish();
}

bool Certificate::readHead(const std::string& key, Line& line) {
  if (!contains(kHead, key)) return false;
  require(head_.insert(key).second, key + " is given twice");
  if (key == "map") {
    require(line.word() == hexText(map_.checksum) && line.count(SIZE_MAX) == map_.size,
            "the certificate is of another map");
  } else if (key == "problem") {
    require(line.word() == hexText(xxh64(map_.problem)) && line.count(SIZE_MAX) == map_.problem.size(),
            "the certificate is of another problem");
  } else if (key == "tolerances") {
    law_tolerance_ = line.real();
    plane_tolerance_ = line.real();
  } else if (key == "convexity") {
    convexity_ = line.word();
    penalty_ = line.real();
  } else if (key == "coverage") {
    coverage_ = line.word();
  } else if (key == "regions") {
    require(line.count(kMany) == map_.regions.size(), "the certificate is of another number of regions");
  } else {
    for (std::size_t k = line.count(kMany); k > 0; --k) {
      const std::size_t row = line.count(kMany);
      if (key == "basis")
        basis_.push_back(row);
      else
        equalities_.insert(row);
    }
  }
  return true;
}

bool Certificate::readRegion(const std::string& key, Line& line) {
  if (key == "region") {
    require(line.count(kMany) == claims_.size() && claims_.size() < map_.regions.size(),
            "regions are out of order");
    claims_.emplace_back();
    return true;
  }
  if (key != "inside" && key != "follows" && key != "facet") return false;
  Claim& claim = lastClaim(key);
  if (key == "inside") {
    while (!line.done()) claim.point.push_back(line.fraction());
  } else if (key == "follows") {
    readFollows(key, line);
  } else {
    require(line.count(kMany) == claim.listed.size(), "facets are out of order");
    claim.listed.push_back(line.word());
    claim.facet_proofs.push_back(line.rest());
  }
  return true;
}

Claim& Certificate::lastClaim(const std::string& key) {
  require(!claims_.empty(), key + " before the first region");
  return claims_.back();
}

void Certificate::readFollows(const std::string& key, Line& line) {
  Claim& claim = lastClaim(key);
  const std::string origin = line.word();
  const Integer scale = line.integer();
  require(claim.proofs.emplace(key + " " + origin, std::make_pair(scale, readWeights(line))).second,
          "a row is proven twice");
}

/// Nothing is left out, and the tolerances are such that "within" means something: the map's look-up reaches
/// twice as far as planes may differ.
void Certificate::checkHead() const {
  for (const char* const key : kHead) require(head_.count(key) > 0, std::string(key) + " is missing");
  require(law_tolerance_ >= 0 && law_tolerance_ <= Fraction(kMostLawTolerance),
          "the law tolerance is out of range");
  require(plane_tolerance_ >= 0 && plane_tolerance_ <= Fraction(kMostPlaneTolerance) &&
              2 * plane_tolerance_ <= Fraction(map_.tolerance),
          "the plane tolerance is out of range");
  requireKinds(convexity_, coverage_);
}

void Certificate::requireKinds(const std::string& convexity, const std::string& coverage) const {
  require(convexity == "definite", "convexity: " + convexity);
  require(coverage == "exact", "coverage: " + coverage);
}

void Certificate::requireCount(std::size_t claims) const {
  require(claims == map_.regions.size() && claims > 0, "regions are missing");
}

void Certificate::checkSizes() {
  n_ = data("H").rows;
  m_ = data("A").rows;
  p_ = map_.p;
  q_ = map_.q;
  requireSizes(data_, n_, m_, p_, q_);
  for (std::size_t j = 0; j < p_; ++j) {
    const Fraction lower = data("box").at(j, 0), upper = data("box").at(j, 1);
    require(
        lower == Fraction(map_.bounds[2 * j]) && upper == Fraction(map_.bounds[2 * j + 1]) && lower < upper,
        "the box is not the map's");
  }
  for (const std::size_t row : equalities_) require(row < m_, "equalities names no row");
  for (const std::size_t row : basis_) require(row < m_, "basis names no row");
  requireCount(claims_.size());
}

const Matrix& Certificate::data(const std::string& name) const {
  const auto at = data_.find(name);
  require(at != data_.end(), name + " is missing");
  return at->second;
}

void Certificate::check() const {
  checkProgram();
  std::set<std::set<std::size_t>> seen;
  std::vector<ProvenRegion> proven;
  for (std::size_t index = 0; index < claims_.size(); ++index) {
    progress("region", index, claims_.size());
    try {
      const Region region = checkedRegion(index);
      require(seen.insert(region.active).second, "another region has the same active set");
      proven.push_back(checkRegion(index, region));
    } catch (const Refused& error) {
      throw Refused("region " + std::to_string(index) + ": " + error.what());
    }
  }
  checkLookups(proven);
}

ProvenRegion Certificate::checkRegion(std::size_t index, const Region& region) const {
  checkLaw(index, region);
  return proveFacets(index, region);
}

ProvenRegion Certificate::proveFacets(std::size_t index, const Region& region) const {
  ProvenRegion proven;
  proven.plane_error = region.plane_error;
  for (std::size_t facet = 0; facet < region.listed.size(); ++facet)
    proven.facets.push_back(checkFacet(index, region, facet));
  return proven;
}

void Certificate::checkLookups(const std::vector<ProvenRegion>& regions) const {
  const auto rows = [this](std::size_t region) { return checkedRegion(region).listed; };
  Lookups(map_, plane_tolerance_, regions, rows).check(lookups_, progress);
}

bool Certificate::statesBounds() const {
  if (convexity_ != "definite" || coverage_ != "exact") return false;
  if (claims_.size() != map_.regions.size()) return false;
  for (std::size_t r = 0; r < claims_.size(); ++r)
    if (claims_[r].listed.size() > map_.regions[r].row_count) return false;
  return true;
}

std::string Certificate::conditions() const {
  constexpr double kUp = 1.006;  // so that three digits are not below
  char text[400];
  std::snprintf(
      text, sizeof text,
      "differences from the exact solution in the whole box: u at most %.3g (%g of its law's greatest), "
      "planes at most %g (scaled)\nlook-ups: half-spaces are violated by at most %g (scaled)\n",
      kUp * law_error_.get_d(), law_tolerance_.get_d(), plane_tolerance_.get_d(), kReach * map_.tolerance);
  return statesBounds() ? text + boundsOfAnswers(kUp) : text;
}

std::string Certificate::boundsOfAnswers(double up) const {
  // One tolerance more allows for the difference of the map's plane.
  const Fraction reach = (kReach + 1) * Fraction(map_.tolerance);
  const Fraction beyond = 2 * reach * greatest_change_ + 2 * law_tolerance_ * greatest_scale_;
  char text[200];
  std::snprintf(text, sizeof text,
                "beyond a facet, u differs by at most %.3g from that of the region behind it\n",
                up * beyond.get_d());
  return text;
}

}  // namespace checker
