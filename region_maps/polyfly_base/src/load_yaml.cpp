#include "polyfly_base/load_yaml.hpp"

#include <yaml-cpp/eventhandler.h>

#include <algorithm>
#include <cstddef>
#include <sstream>
#include <vector>

#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

/// Notes where the last document begins, and refuses an alias of what holds it: a reader would never come to its end.
class DocumentCheck : public YAML::EventHandler {
 public:
  void OnDocumentStart(const YAML::Mark& mark) override { line = mark.line; }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    if (std::count(open_.begin(), open_.end(), anchor) > 0)
      throw YAML::ParserException(mark, "an alias of what holds it");
  }
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t, const std::string&) override {}
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open_.push_back(anchor);
  }
  void OnSequenceEnd() override { open_.pop_back(); }
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open_.push_back(anchor);
  }
  void OnMapEnd() override { open_.pop_back(); }

  int line = 0;

 private:
  /// Of the lists and maps around the present place; 0: without one.
  std::vector<YAML::anchor_t> open_;
};

std::string place(const std::string& source, int line) {
  return source + ":" + std::to_string(std::max(line, 0) + 1) + ": file: ";
}

// yaml-cpp takes \4 for the end of the text. Its version 0.6 never ends on a list or map in brackets where ':' stands right
// before ']' or the end. Texts of two bytes per character hold zeros.
void refuseTrap(const std::string& text, const std::string& source) {
  const auto refuseAt = [&](auto character, const char* rule) {
    throw Error(place(source, static_cast<int>(std::count(text.begin(), character, '\n'))) + rule);
  };
  const auto isControl = [](unsigned char c) { return c < ' ' && c != '\t' && c != '\n' && c != '\r'; };
  const auto control = std::find_if(text.begin(), text.end(), isControl);
  if (control != text.end()) refuseAt(control, "must be UTF-8 without control characters");
  const std::size_t colon = (text + ']').find(":]");
  if (colon == std::string::npos) return;
  refuseAt(text.begin() + static_cast<std::ptrdiff_t>(colon),
           "must have a space or a line break between ':' and ']' or the end");
}

}  // namespace

YAML::Node loadYaml(const std::string& text, const std::string& source) {
  refuseTrap(text, source);
  try {
    // Load alone would drop what follows the first document; LoadAll never ends on some malformed texts.
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    DocumentCheck check;
    if (parser.HandleNextDocument(check) && parser.HandleNextDocument(check)) {
      throw Error(place(source, check.line) + "must end after one YAML document");
    }
    return YAML::Load(text);
  } catch (const YAML::Exception& error) {
    throw Error(place(source, error.mark.line) + "is not valid YAML: " + error.msg);
  }
}

}  // namespace polyfly
