#include "polyfly_ros/option_table.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

namespace polyfly_ros {

void OptionTable::add(const std::string& parameter, std::variant<double*, int*, bool*> field,
                      const char* unit, const polyfly::Range& range) {
  if (fixed_.count(parameter) != 0) return;
  std::string name = parameter;
  std::replace(name.begin(), name.end(), '/', separator_);
  options_.push_back({name, parameter, parameter.substr(0, parameter.find('/')), unit, range, field});
}

std::vector<std::string> OptionTable::groups() const {
  std::vector<std::string> names;
  for (const Option& option : options_) {
    if (std::find(names.begin(), names.end(), option.group) == names.end()) names.push_back(option.group);
  }
  return names;
}

const OptionTable::Option* OptionTable::find(const std::string& name) const {
  const auto found = std::find_if(options_.begin(), options_.end(),
                                  [&](const Option& option) { return option.name == name; });
  return found == options_.end() ? nullptr : &*found;
}

void OptionTable::alias(const LegacyName& name) {
  const Option* option = find(name.ours);
  if (option == nullptr || name.element >= 0) return;
  const auto known = std::find_if(aliases_.begin(), aliases_.end(),
                                  [&](const Alias& entry) { return entry.name == name.theirs; });
  Alias& alias = known == aliases_.end() ? aliases_.emplace_back(Alias{name.theirs, {}}) : *known;
  alias.links.push_back({static_cast<std::size_t>(option - options_.data()), name});
}

double OptionTable::get(const Option& option) {
  return std::visit([](const auto* field) { return static_cast<double>(*field); }, option.field);
}

bool OptionTable::set(const Option& option, double value) {
  const double before = get(option);
  if (std::isnan(value)) return false;
  const double clamped = std::clamp(value, option.range.least, option.range.greatest);
  const auto assign = [&](auto* field) {
    using Value = std::decay_t<decltype(*field)>;
    *field = static_cast<Value>(std::is_same_v<Value, int> ? std::round(clamped) : clamped);
  };
  std::visit(assign, option.field);
  return get(option) != before;
}

std::vector<double> OptionTable::values() const {
  std::vector<double> all;
  for (const Option& option : options_) all.push_back(get(option));
  return all;
}

polyfly::ChangeBounds OptionTable::bounds() const {
  std::vector<polyfly::ChangeBounds::Option> options;
  for (const Option& option : options_) options.push_back({option.parameter, option.unit, option.range});
  return {std::move(options), values()};
}

void OptionTable::restore(const std::vector<double>& values) {
  for (std::size_t i = 0; i < options_.size(); ++i) set(options_[i], values[i]);
}

}  // namespace polyfly_ros
