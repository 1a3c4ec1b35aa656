#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
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

/// Appends results to bytes.
class ResultWriter {
 public:
  explicit ResultWriter(std::vector<std::byte>& bytes) : out_(bytes) {}

  template <typename... T>
  void operator()(const T&... values) {
    (put(values), ...);
  }

 private:
  template <typename T>
  void put(const T& value) {
    if constexpr (std::is_trivially_copyable_v<T>) {
      out_.put(value);
    } else {
      members(*this, const_cast<T&>(value));
    }
  }
  template <typename First, typename Second>
  void put(const std::pair<First, Second>& pair) {
    (*this)(pair.first, pair.second);
  }
  template <typename T>
  void put(const std::vector<T>& list) {
    putAll(list, list.size());
  }
  template <typename T>
  void put(const std::set<T>& list) {
    putAll(list, list.size());
  }
  void put(const std::string& text) { putAll(text, text.size()); }
  void put(const Eigen::VectorXd& vector) {
    out_.put(static_cast<std::uint64_t>(vector.size()));
    for (Eigen::Index i = 0; i < vector.size(); ++i) put(vector[i]);
  }
  void put(const Integer& number) { put(number.get_str(kBase)); }
  void put(const Rational& number) { put(number.get_str(kBase)); }

  template <typename List>
  void putAll(const List& list, std::size_t size) {
    out_.put(static_cast<std::uint64_t>(size));
    for (const auto& value : list) put(value);
  }

  static constexpr int kBase = 16;
  ByteWriter out_;
};

/// Reads what ResultWriter wrote.
class ResultReader {
 public:
  explicit ResultReader(const std::vector<std::byte>& bytes)
      : in_(bytes.data(), bytes.size(), "message of the group") {}

  template <typename... T>
  void operator()(T&... values) {
    (get(values), ...);
  }

 private:
  template <typename T>
  void get(T& value) {
    if constexpr (std::is_trivially_copyable_v<T>) {
      value = in_.get<T>();
    } else {
      members(*this, value);
    }
  }
  template <typename First, typename Second>
  void get(std::pair<First, Second>& pair) {
    (*this)(pair.first, pair.second);
  }
  template <typename T>
  void get(std::vector<T>& list) {
    list.resize(size());
    for (T& value : list) get(value);
  }
  template <typename T>
  void get(std::set<T>& list) {
    list.clear();
    for (std::size_t left = size(); left > 0; --left) {
      T value{};
      get(value);
      list.insert(list.end(), value);
    }
  }
  void get(std::string& text) {
    text.resize(size());
    in_.getArray(text.data(), text.size());
  }
  void get(Eigen::VectorXd& vector) {
    vector.resize(static_cast<Eigen::Index>(size()));
    in_.getArray(vector.data(), static_cast<std::size_t>(vector.size()));
  }
  void get(Integer& number) { number.set_str(text(), kBase); }
  void get(Rational& number) { number.set_str(text(), kBase); }

  std::string text() {
    std::string text;
    get(text);
    return text;
  }
  std::size_t size() {
    const auto size = in_.get<std::uint64_t>();
    in_.need(size, 1);
    return size;
  }

  static constexpr int kBase = 16;
  ByteReader in_;
};

}  // namespace polyfly
