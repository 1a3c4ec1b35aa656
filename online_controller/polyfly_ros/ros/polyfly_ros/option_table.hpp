#pragma once

#include <set>
#include <string>
#include <variant>
#include <vector>

#include "polyfly_base/change_bounds.hpp"
#include "polyfly_base/range.hpp"
#include "polyfly_ros/parameter_reader.hpp"

namespace polyfly_ros {

/// Options by name, for dynamic_reconfigure. It is the visitor of the options' lists, so that names, units
/// and ranges stand in one place. Keeps pointers to the fields.
class OptionTable {
 public:
  struct Option {
    /// Name in dynamic_reconfigure.
    std::string name;
    /// Name below the node's private namespace, as `group/name`.
    std::string parameter;
    std::string group;
    std::string unit;
    polyfly::Range range;
    std::variant<double*, int*, bool*> field;
  };

  /// What another program calls an option, or several at once. Its value is that of the first link.
  struct Alias {
    struct Link {
      std::size_t option;  ///< its place in options()
      LegacyName name;
    };
    std::string name;
    std::vector<Link> links;
  };

  /// Leaves out the options of these parameters: they cannot change while the node runs. In
  /// dynamic_reconfigure the slash of a parameter is replaced by `separator`.
  explicit OptionTable(std::set<std::string> fixed, char separator = '/')
      : fixed_(std::move(fixed)), separator_(separator) {}

  void operator()(const char* key, double& field, const char* unit, const polyfly::Range& range) {
    add(key, &field, unit, range);
  }
  void operator()(const char* key, int& field, const char* unit, const polyfly::Range& range) {
    add(key, &field, unit, range);
  }
  void operator()(const char* key, bool& field) { add(key, &field, "", polyfly::anyChange(0.0, 1.0)); }

  const std::vector<Option>& options() const noexcept { return options_; }
  /// Groups in the order of the options.
  std::vector<std::string> groups() const;

  /// nullptr when there is none.
  const Option* find(const std::string& name) const;

  /// `theirs` stands for `ours` too; nothing without such an option, or where theirs is a list.
  void alias(const LegacyName& name);
  const std::vector<Alias>& aliases() const noexcept { return aliases_; }
  const Option& first(const Alias& alias) const { return options_[alias.links.front().option]; }
  /// How far they may be changed in flight, from the present values.
  polyfly::ChangeBounds bounds() const;

  /// All values, and putting them back.
  std::vector<double> values() const;
  void restore(const std::vector<double>& values);

  /// Clamped to the range. Whether the option has another value now.
  static bool set(const Option& option, double value);
  static double get(const Option& option);

 private:
  void add(const std::string& parameter, std::variant<double*, int*, bool*> field, const char* unit,
           const polyfly::Range& range);

  std::set<std::string> fixed_;
  char separator_;
  std::vector<Option> options_;
  std::vector<Alias> aliases_;
};

}  // namespace polyfly_ros
