#include "count_proof.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

#include "checksum.hpp"
#include "files.hpp"
#include "json_problem.hpp"

namespace checker {
namespace {

constexpr std::size_t kWitnessBytes = 5;
constexpr int kWitnessBits = 39;
constexpr std::size_t kPiece = 4096;  // records read at a time

bool isPositive(const Fraction& a) { return a > 0; }

Fraction numberOf(std::int64_t steps, const Fraction*) {
  return Fraction(mpz_class(static_cast<long>(steps)), mpz_class(1) << kWitnessBits);
}
Bounded numberOf(std::int64_t steps, const Bounded*) {
  return std::ldexp(static_cast<double>(steps), -kWitnessBits);
}

Bounded toBounded(const Fraction& a) {
  const double value = a.get_d();  // cut off, not rounded
  return rounded(value, std::abs(value) * 0x1.0p-52 + 0x1.0p-1000);
}

std::vector<Bounded> toBounded(const Vector& values) {
  std::vector<Bounded> result;
  for (const Fraction& value : values) result.push_back(toBounded(value));
  return result;
}

}  // namespace

/// Keys and sums of the records that a thread has checked.
struct CountProof::Share {
  Size size;
  std::vector<std::uint64_t> keys;  // words of each
};

CountProof::CountProof(const std::string& path) : path_(path) {
  requireFile(path);
  file_.open(path, std::ios::binary);
  if (!file_) throw Unreadable(path + ": cannot be read");
  readHead();
  findMultiples();
  reduce();
  findGaps();
}

const Matrix& CountProof::data(const std::string& name) const {
  const auto at = data_.find(name);
  require(at != data_.end(), name + " is missing");
  return at->second;
}

void CountProof::readHead() {
  // No more is read before it is known what the file is.
  const std::string first = "polyfly count 1\n";
  std::string text(first.size(), '\0');
  file_.read(text.data(), static_cast<std::streamsize>(text.size()));
  require(file_ && text == first, "not a count of version 1");
  std::set<std::string> seen;
  while (record_bytes_ == 0) {
    require(static_cast<bool>(std::getline(file_, text)), "there are no records");
    Line line(text);
    const std::string key = line.word();
    require(seen.insert(key).second, key + " is given twice");
    if (key == "problem") {
      problem_ = line.rest();
    } else if (key == "equalities") {
      for (std::size_t k = line.count(kMany); k > 0; --k) equalities_.insert(line.count(kMany));
    } else if (key == "weights") {
      weights_ = readMatrix(line, key);
    } else if (key == "records") {
      record_bytes_ = line.count(kMany);
    } else {
      data_.emplace(key, readMatrix(line, key));
    }
    line.end();
  }
  for (const char* const key : {"problem", "equalities", "weights"})
    require(seen.count(key) > 0, std::string(key) + " is missing");
  n_ = data("H").rows;
  m_ = data("A").rows;
  p_ = data("box").rows;
  q_ = data("E").rows;
  requireSizes(data_, n_, m_, p_, q_);
  require(equalities_.empty() || *equalities_.rbegin() < m_, "no such row");
  key_bytes_ = (m_ + 7) / 8;
  require(p_ > 0 && record_bytes_ == key_bytes_ + kWitnessBytes * p_, "records are of another size");
  for (std::size_t j = 0; j < p_; ++j)
    require(data("box").at(j, 0) < data("box").at(j, 1), "a parameter has no range");
}

void CountProof::compareProblem(const std::string& problem) const {
  require(problem_ == hexText(xxh64(problem)) + " " + std::to_string(problem.size()),
          "the problem file is not the one that was counted");
  const std::size_t first = problem.find_first_not_of(" \t\r\n");
  if (first == std::string::npos || problem[first] != '{') return;
  compareNumbers(problem, data_, equalities_);
}

// gram = A H^-1 A', D = (b + S theta) + A H^-1 (f + F theta) as functions of (t, 1), by H = L diag L'; all
// entries of diag must be positive.
void CountProof::reduce() {
  const Matrix& box = data("box");
  Vector centre, half;
  for (std::size_t j = 0; j < p_; ++j) {
    centre.push_back((box.at(j, 0) + box.at(j, 1)) / 2);
    half.push_back((box.at(j, 1) - box.at(j, 0)) / 2);
  }
  const auto affine = [&](const std::string& matrix, const std::string& vector, std::size_t row, int sign) {
    Vector result;
    Fraction constant = data(vector).at(row, 0);
    for (std::size_t j = 0; j < p_; ++j) {
      result.push_back(sign * data(matrix).at(row, j) * half[j]);
      constant += sign * data(matrix).at(row, j) * centre[j];
    }
    result.push_back(constant);
    return result;
  };
  // columns of L^-1 A', then of L^-1 (F f), scaled by 1 / sqrt(diag) in the products below
  const std::size_t width = m_ + p_ + 1;
  Vector H = data("H").entries, right(n_ * width), diagonal;
  for (std::size_t i = 0; i < n_; ++i) {
    for (std::size_t r = 0; r < m_; ++r) right[i * width + r] = data("A").at(r, i);
    const Vector cost = affine("F", "f", i, 1);
    std::copy(cost.begin(), cost.end(), right.begin() + static_cast<std::ptrdiff_t>(i * width + m_));
  }
  for (std::size_t c = 0; c < n_; ++c) {
    const Fraction pivot = H[c * n_ + c];
    require(pivot > 0, "H is not positive definite");
    diagonal.push_back(pivot);
    for (std::size_t r = c + 1; r < n_; ++r) {
      require(data("H").at(r, c) == data("H").at(c, r), "H is not symmetric");
      const Fraction factor = H[r * n_ + c] / pivot;
      if (factor == 0) continue;
      for (std::size_t j = c; j < n_; ++j) H[r * n_ + j] -= factor * H[c * n_ + j];
      for (std::size_t j = 0; j < width; ++j) right[r * width + j] -= factor * right[c * width + j];
    }
  }
  const auto product = [&](std::size_t a, std::size_t b) {
    Fraction sum = 0;
    for (std::size_t i = 0; i < n_; ++i) sum += right[i * width + a] * right[i * width + b] / diagonal[i];
    return sum;
  };
  for (std::size_t i = 0; i < m_; ++i) {
    for (std::size_t j = 0; j < m_; ++j)
      exact_.gram.push_back(j < i ? exact_.gram[j * m_ + i] : product(i, j));
    const Vector bound = affine("S", "b", i, 1);
    for (std::size_t j = 0; j <= p_; ++j) exact_.D.push_back(bound[j] + product(i, m_ + j));
  }
  for (std::size_t i = 0; i < data("A_theta").rows; ++i) {
    const Vector room = affine("A_theta", "b_theta", i, -1);
    exact_.domain.insert(exact_.domain.end(), room.begin(), room.end());
  }
  bounded_.gram = toBounded(exact_.gram);
  bounded_.D = toBounded(exact_.D);
  bounded_.domain = toBounded(exact_.domain);
}

// Rows that are positive multiples of each other: (A, S, b) divided by the first entry's size.
void CountProof::findMultiples() {
  std::map<Vector, std::size_t> first;
  for (std::size_t i = 0; i < m_; ++i) {
    Vector row;
    for (std::size_t j = 0; j < n_; ++j) row.push_back(data("A").at(i, j));
    for (std::size_t j = 0; j < p_; ++j) row.push_back(data("S").at(i, j));
    row.push_back(data("b").at(i, 0));
    const auto lead = std::find_if(row.begin(), row.end(), [](const Fraction& a) { return a != 0; });
    const Fraction size = lead == row.end() ? Fraction(1) : abs(*lead);
    for (Fraction& value : row) value /= size;
    first_of_.push_back(first.emplace(row, i).first->second);
  }
}

// Greatest |z_j|: the weights make sums of rows that say z_j or -z_j, but for a rest, is at most a number.
Fraction CountProof::greatestVariable() const {
  Fraction bound = 0, left = 0;
  for (std::size_t j = 0; j < weights_.rows; ++j) {
    for (std::size_t i = 0; i < m_; ++i)
      require(equalities_.count(i) > 0 || weights_.at(j, i) >= 0, "a weight is negative");
    Fraction rest = 0, most = 0;
    for (std::size_t c = 0; c < n_; ++c) {
      Fraction entry = c == j / 2 ? (j % 2 == 0 ? 1 : -1) : 0;
      for (std::size_t i = 0; i < m_; ++i) entry -= weights_.at(j, i) * data("A").at(i, c);
      rest += abs(entry);
    }
    for (std::size_t i = 0; i < m_; ++i) most += weights_.at(j, i) * data("b").at(i, 0);
    for (std::size_t c = 0; c < p_; ++c) {
      Fraction slope = 0;
      for (std::size_t i = 0; i < m_; ++i) slope += weights_.at(j, i) * data("S").at(i, c);
      most += std::max(Fraction(slope * data("box").at(c, 0)), Fraction(slope * data("box").at(c, 1)));
    }
    left = std::max(left, rest);
    bound = std::max(bound, most);
  }
  require(left < 1, "the weights do not bound the variables");
  return bound / (1 - left);
}

// Slack of an inactive row beyond which a law is not that of a region where the row is active.
void CountProof::findGaps() {
  if (weights_.rows == 0) return;
  require(weights_.rows == 2 * n_ && weights_.columns == m_, "weights: their size does not fit");
  for (std::size_t j = 0; j < n_; ++j) {
    bool is_output = false;
    for (std::size_t i = 0; i < q_ && !is_output; ++i) {
      is_output = data("E").at(i, j) == 1;
      for (std::size_t c = 0; c < n_; ++c) is_output = is_output && (c == j || data("E").at(i, c) == 0);
    }
    require(is_output, "weights, though not every variable is an output");
  }
  const Fraction variable = greatestVariable();
  Fraction output = 1;
  for (std::size_t i = 0; i < q_; ++i) {
    Fraction most = abs(data("c").at(i, 0));
    for (std::size_t j = 0; j < n_; ++j) most += abs(data("E").at(i, j)) * variable;
    for (std::size_t j = 0; j < p_; ++j) {
      const Fraction reach =
          std::max(Fraction(abs(data("box").at(j, 0))), Fraction(abs(data("box").at(j, 1))));
      most += abs(data("C").at(i, j)) * reach;
    }
    output = std::max(output, most);
  }
  const Fraction same_law(1, 1000000000);
  const Fraction difference = 4 * Fraction(static_cast<unsigned long>(p_) + 1) * same_law * output;
  for (std::size_t i = 0; i < m_; ++i) {
    Fraction size = 0;
    for (std::size_t j = 0; j < n_; ++j) size += abs(data("A").at(i, j));
    exact_.gap.push_back(difference * size);
  }
  bounded_.gap = toBounded(exact_.gap);
}

CountProof::Record CountProof::record(const unsigned char* bytes) const {
  Record record;
  for (std::size_t i = 0; i < 8 * key_bytes_; ++i) {
    if ((bytes[i / 8] >> i % 8 & 1u) != 0) record.set.push_back(i);
  }
  bytes += key_bytes_;
  for (std::size_t j = 0; j < p_; ++j, bytes += kWitnessBytes) {
    std::int64_t value = (bytes[kWitnessBytes - 1] & 0x80u) != 0 ? -1 : 0;
    for (std::size_t k = kWitnessBytes; k-- > 0;) value = value * 256 + bytes[k];
    record.t.push_back(value);
  }
  return record;
}

void CountProof::requireProper(const Record& record) const {
  for (const std::size_t row : record.set) {
    require(row < m_ && equalities_.count(row) == 0, "a set has a row that is no inequality");
    require(first_of_[row] == row, "a set has a row that repeats another");
  }
  for (const std::int64_t t : record.t)
    require(std::abs(t) < std::int64_t{1} << kWitnessBits, "a witness lies outside of the box");
}

template <typename Number>
bool CountProof::confirms(const Reduced<Number>& reduced, const Record& record, bool& apart) const {
  const Number* const kind = nullptr;
  std::vector<Number> t;
  for (const std::int64_t steps : record.t) t.push_back(numberOf(steps, kind));
  const auto value_at = [&](const Number* affine) {
    Number sum = affine[p_];
    for (std::size_t j = 0; j < p_; ++j) sum = sum + affine[j] * t[j];
    return sum;
  };
  for (std::size_t i = 0; i < reduced.domain.size(); i += p_ + 1)
    if (!isPositive(value_at(reduced.domain.data() + i))) return false;

  std::vector<std::size_t> rows(equalities_.begin(), equalities_.end());
  rows.insert(rows.end(), record.set.begin(), record.set.end());
  const std::size_t k = rows.size();
  // Gram matrix of the rows, and D (t, 1) with the sign changed.
  std::vector<Number> matrix(k * k), multipliers(k);
  for (std::size_t r = 0; r < k; ++r) {
    for (std::size_t c = 0; c < k; ++c) matrix[r * k + c] = reduced.gram[rows[r] * m_ + rows[c]];
    multipliers[r] = Number(0.0) - value_at(reduced.D.data() + rows[r] * (p_ + 1));
  }
  for (std::size_t c = 0; c < k; ++c) {
    // The rows are dependent, or rounding leaves that open.
    if (!isPositive(matrix[c * k + c])) return false;
    for (std::size_t r = c + 1; r < k; ++r) {
      const Number factor = matrix[r * k + c] / matrix[c * k + c];
      for (std::size_t j = c + 1; j < k; ++j)
        matrix[r * k + j] = matrix[r * k + j] - factor * matrix[c * k + j];
      multipliers[r] = multipliers[r] - factor * multipliers[c];
    }
  }
  for (std::size_t r = k; r-- > 0;) {
    for (std::size_t c = r + 1; c < k; ++c)
      multipliers[r] = multipliers[r] - matrix[r * k + c] * multipliers[c];
    multipliers[r] = multipliers[r] / matrix[r * k + r];
    if (r >= equalities_.size() && !isPositive(multipliers[r])) return false;
  }
  apart = !reduced.gap.empty();
  for (std::size_t i = 0; i < m_; ++i) {
    const std::size_t first = first_of_[i];
    if (std::binary_search(record.set.begin(), record.set.end(), first) || equalities_.count(i) > 0) continue;
    Number slack = value_at(reduced.D.data() + i * (p_ + 1));
    for (std::size_t r = 0; r < k; ++r) slack = slack + reduced.gram[i * m_ + rows[r]] * multipliers[r];
    if (!isPositive(slack)) return false;
    apart = apart && isPositive(Number(slack - reduced.gap[i]));
  }
  return true;
}

void CountProof::checkPiece(const std::vector<unsigned char>& bytes, Share& share) const {
  require(bytes.size() % record_bytes_ == 0, "the last record is cut off");
  const std::size_t words = (key_bytes_ + 7) / 8;
  for (std::size_t at = 0; at < bytes.size(); at += record_bytes_) {
    const Record found = record(bytes.data() + at);
    requireProper(found);
    bool apart = false;
    if (!confirms(bounded_, found, apart)) {
      require(confirms(exact_, found, apart), "a set is not optimal at its witness, or not strictly");
      ++share.size.exact;
    }
    ++share.size.regions;
    share.size.active_rows += found.set.size();
    share.size.laws += apart ? 1 : 0;
    const std::size_t key = share.keys.size();
    share.keys.resize(key + words);
    std::memcpy(share.keys.data() + key, bytes.data() + at, key_bytes_);
  }
}

namespace {

/// Throws when two keys of `words` words are equal. Takes `keys` apart.
template <std::size_t kMost>
void requireDistinct(std::size_t words, std::vector<std::vector<std::uint64_t>>& keys) {
  std::vector<std::array<std::uint64_t, kMost>> sorted;
  std::size_t count = 0;
  for (const auto& some : keys) count += some.size() / words;
  sorted.reserve(count);
  for (auto& some : keys) {
    for (auto at = some.begin(); at != some.end(); at += static_cast<std::ptrdiff_t>(words))
      std::copy_n(at, words, sorted.emplace_back().begin());
    std::vector<std::uint64_t>().swap(some);
  }
  std::sort(sorted.begin(), sorted.end());
  require(std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end(), "a set is counted twice");
}

void requireAllDistinct(std::size_t words, std::vector<std::vector<std::uint64_t>>& keys) {
  require(words <= 16, "sets of more than 1024 rows are not checked");
  if (words == 1) return requireDistinct<1>(words, keys);
  if (words <= 4) return requireDistinct<4>(words, keys);
  requireDistinct<16>(words, keys);
}

}  // namespace

Size CountProof::check(int threads) {
  std::vector<Share> shares(static_cast<std::size_t>(threads));
  std::mutex mutex;
  std::exception_ptr failure;
  const auto next = [&](std::vector<unsigned char>& bytes) {
    const std::lock_guard<std::mutex> lock(mutex);
    bytes.resize(kPiece * record_bytes_);
    if (failure || !file_) return false;
    file_.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    bytes.resize(static_cast<std::size_t>(file_.gcount()));
    return !bytes.empty();
  };
  const auto work = [&](Share& share) {
    try {
      for (std::vector<unsigned char> bytes; next(bytes);) checkPiece(bytes, share);
    } catch (...) {
      const std::lock_guard<std::mutex> lock(mutex);
      if (!failure) failure = std::current_exception();
    }
  };
  std::vector<std::thread> workers;
  workers.reserve(shares.size());
  try {
    for (Share& share : shares) workers.emplace_back(work, std::ref(share));
  } catch (...) {  // no memory for a further thread: fewer do the same
  }
  if (workers.empty()) work(shares.front());
  for (std::thread& worker : workers) worker.join();
  if (failure) std::rethrow_exception(failure);
  Size size;
  std::vector<std::vector<std::uint64_t>> keys;
  for (Share& share : shares) {
    size.regions += share.size.regions;
    size.active_rows += share.size.active_rows;
    size.laws += share.size.laws;
    size.exact += share.size.exact;
    keys.push_back(std::move(share.keys));
  }
  require(size.regions > 0, "there are no records");
  requireAllDistinct((key_bytes_ + 7) / 8, keys);
  size.bytes = leastBytes(size);
  return size;
}

// By the sections of region_maps/FORMAT.md.
std::uint64_t CountProof::leastBytes(const Size& size) const {
  constexpr std::uint64_t kHeader = 272, kBounds = 16, kRegion = 20, kIndex = 4, kNumber = 8;
  const std::uint64_t of_region = kRegion + kIndex * (p_ + 1) + kIndex;  // rows, and a place in a leaf
  const std::uint64_t laws = std::max<std::uint64_t>(1, size.laws);
  return kHeader + kBounds * (p_ + q_) + of_region * size.regions + kIndex * size.active_rows +
         kNumber * q_ * (p_ + 1) * laws;
}

}  // namespace checker
