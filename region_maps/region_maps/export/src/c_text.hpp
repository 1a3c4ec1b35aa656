#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "map_export/export_map.hpp"
#include "region_maps/signal.hpp"

namespace polyfly {

using Replacements = std::map<std::string, std::string>;

/// The text with each @key@ replaced. Every key of the text must be known.
std::string replaced(const std::string& text, const Replacements& replacements);

/// A constant of the type that reads back as the same number.
std::string constant(double value, ExportType type);

/// The shortest decimal number that is at least `value`, with few digits.
std::string roundedUp(double value);

/// The same for one that is at most `value`.
std::string roundedDown(double value);

/// One element a constant, in lines of bounded width, between braces. Rows of `width` numbers have braces of their
/// own; 0: the table has one dimension. An empty table has one row of zeros, as C demands.
std::string initialiser(const std::vector<double>& values, std::size_t width, ExportType type);
std::string initialiser(const std::vector<std::uint32_t>& values, std::size_t width);

/// Number of rows that the initialiser has.
std::size_t rowCount(std::size_t values, std::size_t width);

/// The text without what would end a comment or a line of C.
std::string commentText(const std::string& text);

/// Lines of a comment: name, range and unit of each entry of kind[].
std::string signalLines(const char* kind, const std::vector<Signal>& signals);

/// Identifiers' prefix of macros: the name in upper case.
std::string upperCase(const std::string& name);

}  // namespace polyfly
