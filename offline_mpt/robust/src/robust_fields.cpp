#include "robust_fields.hpp"

namespace polyfly {

Rational exactNumber(const YamlField& field) {
  Rational value;
  const std::string text = field.text();
  if (!parseRational(text, value)) field.fail("must be a decimal number or a fraction, got '" + text + "'");
  return value;
}

RationalVector exactVector(const YamlField& field, int size) {
  RationalVector values;
  for (const YamlField& item : field.items()) values.push_back(exactNumber(item));
  if (static_cast<int>(values.size()) != size) field.fail("must have " + std::to_string(size) + " entries");
  return values;
}

RationalMatrix exactMatrix(const YamlField& field, int rows, int columns) {
  const std::vector<YamlField> items = field.items();
  const int count = static_cast<int>(items.size());
  if (rows >= 0 && count != rows) field.fail("must have " + std::to_string(rows) + " rows");
  if (count == 0) field.fail("must have at least one row");
  RationalMatrix matrix(count, columns);
  for (int i = 0; i < count; ++i) {
    const RationalVector row = exactVector(items[static_cast<std::size_t>(i)], columns);
    for (int j = 0; j < columns; ++j) matrix(i, j) = row[static_cast<std::size_t>(j)];
  }
  return matrix;
}

}  // namespace polyfly
