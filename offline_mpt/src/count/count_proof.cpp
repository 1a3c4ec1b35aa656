#include "count/count_proof.hpp"

#include "support/certificate_text.hpp"

namespace polyfly {
namespace {

// Size of one write.
constexpr std::size_t kProofPiece = std::size_t{1} << 20;  // [bytes]
// Bytes of each parameter of a witness.
constexpr std::size_t kWitnessBytes = 5;

}  // namespace

CountProof::CountProof(const std::string& path, const ParametricProgram& program,
                       const Eigen::MatrixXd& weights)
    : draft_(path),
      key_bytes_((static_cast<std::size_t>(program.rowCount()) + 7) / 8),
      parameters_(static_cast<std::size_t>(program.parameterCount())) {
  std::string text = "polyfly count 1\n" + problemLine(program.text) + programLines(program);
  appendMatrix("weights", weights, text);
  text += "records " + std::to_string(key_bytes_ + kWitnessBytes * parameters_) + "\n";
  buffer_.assign(text.begin(), text.end());
}

void CountProof::add(const std::vector<int>& rows, const std::int64_t* witness) {
  const std::size_t key = buffer_.size();
  buffer_.resize(key + key_bytes_);
  for (const int row : rows) {
    const auto i = static_cast<unsigned>(row);
    buffer_[key + i / 8] = static_cast<unsigned char>(buffer_[key + i / 8] | 1u << i % 8);
  }
  for (std::size_t j = 0; j < parameters_; ++j) {
    auto bits = static_cast<std::uint64_t>(witness[j]);  // two's complement
    for (std::size_t k = 0; k < kWitnessBytes; ++k, bits >>= 8)
      buffer_.push_back(static_cast<unsigned char>(bits & 0xffu));
  }
  if (buffer_.size() >= kProofPiece) flush();
}

void CountProof::flush() {
  draft_.write(buffer_.data(), end_, buffer_.size());
  end_ += buffer_.size();
  buffer_.clear();
}

void CountProof::commit() {
  flush();
  draft_.commit();
}

}  // namespace polyfly
