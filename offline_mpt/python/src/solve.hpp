#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "loaded_map.hpp"
#include "offline_mpt/search_tree.hpp"
#include "path_caster.hpp"
#include "polyfly_base/write_file.hpp"
#include "robust_mpc/robust_problem.hpp"

namespace polyfly::python {

/// How a problem is solved; defaults and ranges are those of `offline_mpt solve`.
struct SolveOptions {
  int threads = 0;  ///< 0: all processors
  std::string tree = "auto";
  std::uint64_t region_limit = 10'000'000;
  double time_limit = 0.0;         ///< [s] of the exploration, 0: none
  std::uint64_t memory_limit = 0;  ///< [bytes], 0: none
};

/// That of the modes which has the name. Throws Error where none has it.
TreeMode treeMode(const std::string& name, const std::vector<TreeMode>& modes);

/// Explores a program, encodes its map, and checks answers as `offline_mpt solve` does. A map that a limit ended says so in its
/// status. Throws Error where there is no region to keep, and where an answer is wrong.
std::unique_ptr<LoadedMap> solveProgram(const ParametricProgram& program, const SolveOptions& options,
                                        pybind11::object progress);

/// The map of a minimum-peak robust problem, checked alike. Its limits are of no effect.
std::unique_ptr<LoadedMap> solveRobust(const RobustProblem& problem, const SolveOptions& options,
                                       pybind11::object progress);

/// Adds what all problems have: name, text, and save(path).
template <class Type>
void defineText(Type& type) {
  using Value = typename Type::type;
  type.def_readonly("name", &Value::name)
      .def_readonly("text", &Value::text, "Text of the problem file.")
      .def(
          "save",
          [](const Value& value, const std::filesystem::path& path) {
            writeFileAtomically(path.string(), value.text);
          },
          pybind11::arg("path"), "Writes the problem file.");
}

/// Adds solve(...) to a type. `solver(object, options, progress)` returns the map.
template <class Type, class Solver>
void defineSolve(Type& type, const Solver& solver) {
  namespace py = pybind11;
  using Value = typename Type::type;
  type.def(
      "solve",
      [solver](const Value& value, int threads, const std::string& tree, std::uint64_t region_limit,
               double time_limit, std::uint64_t memory_limit, py::object progress) {
        return solver(value, SolveOptions{threads, tree, region_limit, time_limit, memory_limit},
                      std::move(progress));
      },
      py::kw_only(), py::arg("threads") = 0, py::arg("tree") = "auto",
      py::arg("region_limit") = SolveOptions{}.region_limit, py::arg("time_limit") = 0.0,
      py::arg("memory_limit") = 0, py::arg("progress") = py::none(),
      "Solves for all parameters in the box; returns the Map. Raises Error where its answers fail the check. "
      "The result does not depend on threads (0: all "
      "processors). "
      "tree: fast, auto or small. time_limit [s], memory_limit [bytes]: 0 for none; a map that a limit ended "
      "has the "
      "status 'limited'. progress: True, or a function that takes a text.");
}

}  // namespace polyfly::python
