#pragma once

#include <cstddef>
#include <string>

/// Short words of a certificate ("The file" in offline_mpt/CERTIFICATE.md).
namespace checker::tag {

// Proofs that a cell, or the part of it outside of a row, has no point or is covered.
constexpr char kEmpty[] = "e";
constexpr char kCutByRegion[] = "N";
constexpr char kCutByBoundary[] = "b";
constexpr char kOutsideCovered[] = "s";
constexpr char kAlongPlane[] = "z";

// Origins of rows: what must be >= 0, and of which row or side.
constexpr char kMultiplier = 'm';
constexpr char kCostMultiplier = 'p';
constexpr char kSlack = 's';
constexpr char kDomain = 'd';
constexpr char kSideOfBox = 'b';

inline std::string origin(char kind, std::size_t place) { return kind + std::to_string(place); }

}  // namespace checker::tag
