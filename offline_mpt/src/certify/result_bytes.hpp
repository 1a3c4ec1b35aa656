#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "certify/facet_cover_proof.hpp"
#include "certify/lookup/dropped_rows.hpp"
#include "certify/region_check.hpp"
#include "support/byte_stream.hpp"

namespace polyfly {

/// The members of results that processes send each other, once for writing and reading.
template <typename Archive>
void members(Archive& archive, Defect& defect) {
  archive(defect.kind, defect.region, defect.row, defect.size, defect.witness, defect.missing, defect.text);
}
template <typename Archive>
void members(Archive& archive, ExactRow& row) {
  archive(row.origin, row.value, row.unit, row.bits, row.length);
}
template <typename Archive>
void members(Archive& archive, CheckedFacet& facet) {
  archive(facet.origin, facet.same);
}
template <typename Archive>
void members(Archive& archive, RegionCheck& check) {
  archive(check.described, check.active, check.is_sliver, check.covered_by, check.facets, check.listed,
          check.idle, check.point, check.rows, check.implied, check.left_out, check.forgiven, check.law_error,
          check.plane_error, check.defects, check.text);
}
template <typename Archive>
void members(Archive& archive, FacetBehind& facet) {
  archive(facet.kind, facet.regions);
}
template <typename Archive>
void members(Archive& archive, DroppedRow& row) {
  archive(row.visit, row.row, row.constant, row.least_path_weight, row.most_path_weight, row.row_weight,
          row.rows);
}
template <typename Archive>
void members(Archive& archive, RegionDrops& drops) {
  archive(drops.text, drops.rows, drops.unbounded);
}

/// Appends results to bytes, or reads them back.
class ResultArchive {
 public:
  static ResultArchive writing(std::vector<std::byte>& bytes) {
    ResultArchive archive;
    archive.out_.emplace(bytes);
    return archive;
  }
  static ResultArchive reading(const std::vector<std::byte>& bytes) {
    ResultArchive archive;
    archive.in_.emplace(bytes.data(), bytes.size(), "message of the group");
    return archive;
  }

  template <typename... T>
  void operator()(T&... values) {
    (item(values), ...);
  }

 private:
  ResultArchive() = default;

  template <typename T>
  void item(T& value) {
    if constexpr (!std::is_trivially_copyable_v<T>) {
      members(*this, value);
    } else if (in_) {
      value = in_->get<T>();
    } else {
      out_->put(value);
    }
  }
  template <typename First, typename Second>
  void item(std::pair<First, Second>& pair) {
    (*this)(pair.first, pair.second);
  }
  template <typename T>
  void item(std::vector<T>& list) {
    items(list);
  }
  template <typename T>
  void item(std::set<T>& list) {
    std::vector<T> values(list.begin(), list.end());
    items(values);
    list = std::set<T>(values.begin(), values.end());
  }
  void item(std::string& text) { items(text); }
  void item(Eigen::VectorXd& vector) {
    std::vector<double> values(vector.data(), vector.data() + vector.size());
    items(values);
    vector = Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
  }
  void item(Integer& number) { digits(number); }
  void item(Rational& number) { digits(number); }

  template <typename Number>
  void digits(Number& number) {
    constexpr int kBase = 16;
    std::string text = in_ ? std::string() : number.get_str(kBase);
    items(text);
    if (in_) number.set_str(text, kBase);
  }
  template <typename List>
  void items(List& list) {
    auto size = static_cast<std::uint64_t>(list.size());
    item(size);
    if (in_) {
      in_->need(size, 1);
      list.resize(size);
    }
    for (auto& value : list) item(value);
  }

  std::optional<ByteWriter> out_;
  std::optional<ByteReader> in_;
};

}  // namespace polyfly
