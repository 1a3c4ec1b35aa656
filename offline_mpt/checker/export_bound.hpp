#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "lookup_tables.hpp"

/// How far answers of exported code may be from those of its map.
namespace checker {

/// A leaf of the code and a region of the map.
using LeafRegion = std::pair<std::uint32_t, std::uint32_t>;

/// Holds for every theta of the map's box that is given to the code rounded to the code's type.
struct ExportedAnswers {
  /// Where the map has an answer, the code has one too, and each input differs by at most this.
  std::vector<double> error;
  /// Leaves of the code, each with a region of the map: where they arrive there, the code may have no answer.
  /// `error` does not count these parameters.
  std::set<LeafRegion> missing;
  /// Where the code has an answer, theta violates no half-space of the region by more than this. [scaled]
  double margin = 0.0;
};

/// How a proof is watched and ended early.
struct ProofWatch {
  /// Set from outside: Stopped.
  const std::atomic<bool>* stop = nullptr;
  /// Called now and then with the pairs of leaves that are done.
  std::function<void(std::uint64_t pairs)> progress;
};

struct Stopped {};

/// Proves the bounds of code of floats, for all pairs of leaves at which code and map may arrive for one theta.
class ExportProof {
 public:
  /// Map and watch outlive the proof.
  ExportProof(const Map& map, const LookupTables& code, const ProofWatch& watch);

  ExportedAnswers run();

 private:
  using Candidate = LookupTables::Candidate;
  /// Some candidates of a leaf.
  struct Candidates {
    const Candidate *first, *end;
  };
  /// What is to be done with a part of the cell; `chosen` is nullptr where the look-up has no answer.
  using Visit = std::function<void(const Candidate* chosen)>;

  void look();
  void compareBoxes() const;
  void descend(std::uint32_t code_child, std::uint32_t map_child);
  void compare(std::uint32_t code_leaf, std::uint32_t map_leaf);
  void choices(const LookupTables& tables, const std::vector<Candidate>& leaf, bool visits_outside,
               const Visit& visit);
  void withoutHeld(const LookupTables& tables, const Candidates& candidates,
                   const std::function<void()>& visit);
  void addRow(const LookupTables& tables, std::uint32_t row, double limit);
  void addOutsideRow(const LookupTables& tables, std::uint32_t row, double limit);
  void boundLaws(const Candidate& code, const Candidate& map);
  void visitCandidates(const LookupTables& tables, std::uint32_t child,
                       const std::function<void(const Candidate&)>& visit);
  void boundRows(const Candidate& candidate);

  const Map& regions_;
  const ProofWatch& watch_;
  std::uint64_t pairs_ = 0;
  const LookupTables map_;
  LookupTables code_;
  Cell cell_;
  ExportedAnswers answers_;
};

/// Code of doubles has the tables of its map, number for number, and so the same answers. Planes that no look-up reads
/// may be missing. Throws Refused.
void requireSameTables(const Map& map, const LookupTables& code);

/// The bounds of code of any type. Throws Refused where a table is of another kind or size than the map's.
ExportedAnswers exportedAnswers(const Map& map, const ExportedCode& code, const ProofWatch& watch = {});

/// Compares NAME.json with what is proven of NAME.c and NAME.h. Throws Refused.
void confirmExport(const std::string& facts, const std::string& code, const std::string& header,
                   const Map& map);

}  // namespace checker
