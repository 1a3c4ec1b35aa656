#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <new>

namespace polyfly {

/// Doubles, zero at first, that start on a cache line. Its size is fixed at construction.
class AlignedArray {
 public:
  AlignedArray() = default;
  explicit AlignedArray(std::size_t size)
      : data_(static_cast<double*>(
            ::operator new(std::max<std::size_t>(size, 1) * sizeof(double), kAlignment))) {
    std::fill_n(data_.get(), size, 0.0);
  }

  double* data() noexcept { return data_.get(); }
  const double* data() const noexcept { return data_.get(); }
  double& operator[](int i) noexcept { return data_[static_cast<std::size_t>(i)]; }
  const double& operator[](int i) const noexcept { return data_[static_cast<std::size_t>(i)]; }

 private:
  static constexpr std::align_val_t kAlignment{64};
  struct Free {
    void operator()(double* p) const noexcept { ::operator delete(p, kAlignment); }
  };
  std::unique_ptr<double[], Free> data_;
};

}  // namespace polyfly
