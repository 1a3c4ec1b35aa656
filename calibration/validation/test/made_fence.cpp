#include "made_fence.hpp"

#include <sstream>

#include "offline_mpt/encode.hpp"
#include "offline_mpt/explore.hpp"
#include "region_maps/write_map.hpp"
#include "safety_filter/safe_set.hpp"

namespace polyfly {

void MadeFence::writeMap(const std::string& file) const {
  std::ostringstream text;
  text << "polyfly_problem: 1\nname: fence_x\ntype: safety_filter\nsampling_time: " << period
       << "\ndelay: " << delay
       << "\nmodel:\n  states:\n    - {name: p_x, unit: m, range: [-2, 2]}\n"
          "    - {name: v_x, unit: m/s, range: [-1.5, 1.5]}\n"
          "  inputs:\n    - {name: a_x, unit: m/s^2, range: [-2, 2]}\n"
          "  A: [[0, 1], [0, 0]]\n  B: [[0], [1]]\n";
  const SafetyFilterProblem given = parseSafetyFilter(text.str(), "fence.yaml");
  const ParametricProgram program =
      filterProgram(parseSafetyFilter(withSafeSet(given, computeSafeSet(given)), "fence.yaml"));
  polyfly::writeMap(encode(program, explore(program)), file);
}

}  // namespace polyfly
