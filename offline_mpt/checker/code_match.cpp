#include "code_match.hpp"

#include <algorithm>
#include <cctype>

#include "core/text.hpp"

namespace checker {
namespace {

bool isDigit(char c) { return c >= '0' && c <= '9'; }
bool isWordLetter(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

/// The tokens of a C text. A directive begins with # and ends with a line feed.
class Tokens {
 public:
  explicit Tokens(const std::string& text) : text_(text) {
    for (std::size_t i = 0; i < text.size(); ++i) {
      const auto c = static_cast<unsigned char>(text[i]);
      require(c == '\n' || (c >= ' ' && c != 127), "the code has a control character");
      require(c != '\\' && text.compare(i, 2, "??") != 0, "the code has a line splice or a trigraph");
    }
    while (at_ < text_.size()) readNext();
    endDirective();
  }

  std::vector<std::string> result;

 private:
  void readNext() {
    const char c = text_[at_];
    if (c == '\n') {
      endDirective();
      begins_line_ = true;
      ++at_;
    } else if (c == ' ') {
      ++at_;
    } else if (text_.compare(at_, 2, "/*") == 0) {
      require(!in_directive_, "a directive of the code has a comment");
      const std::size_t end = text_.find("*/", at_ + 2);
      require(end != std::string::npos, "a comment of the code does not end");
      at_ = end + 2;
    } else {
      in_directive_ = in_directive_ || (c == '#' && begins_line_);
      begins_line_ = false;
      result.push_back(text_.substr(at_, lengthOf(c)));
      at_ += result.back().size();
    }
  }

  std::size_t lengthOf(char c) const {
    std::size_t end = at_ + 1;
    if (c == '"') {
      end = text_.find_first_of("\"\n", end);
      require(end != std::string::npos && text_[end] == '"', "a string of the code does not end");
      return end + 1 - at_;
    }
    if (isDigit(c) || (c == '.' && end < text_.size() && isDigit(text_[end]))) {
      while (end < text_.size() && (isWordLetter(text_[end]) || text_[end] == '.' || isExponentSign(end)))
        ++end;
    } else if (isWordLetter(c) || c == '$') {
      while (end < text_.size() && isWordLetter(text_[end])) ++end;
    } else {
      static const std::vector<std::string> two = {
          "<=", ">=", "==", "!=", "&&", "||", "++", "--", "+=", "-=", "<<", ">>", "->",
          "*=", "/=", "%=", "&=", "|=", "^=", "##", "//", "<:", ":>", "<%", "%>", "%:"};
      if (std::find(two.begin(), two.end(), text_.substr(at_, 2)) != two.end()) ++end;
    }
    return end - at_;
  }

  bool isExponentSign(std::size_t at) const {
    const char before = text_[at - 1];
    return (text_[at] == '+' || text_[at] == '-') &&
           (before == 'e' || before == 'E' || before == 'p' || before == 'P');
  }

  void endDirective() {
    if (in_directive_) result.emplace_back("\n");
    in_directive_ = false;
  }

  const std::string& text_;
  std::size_t at_ = 0;
  bool in_directive_ = false;
  bool begins_line_ = true;
};

/// Reads numbers and tables from tokens.
class NumberReader {
 public:
  NumberReader(const std::vector<std::string>& tokens, std::size_t& at) : tokens_(tokens), at_(at) {}

  CodeNumbers read() {
    CodeNumbers numbers;
    if (next() != "{") {
      numbers.texts.push_back(number());
      return numbers;
    }
    ++at_;
    const bool has_rows = next() == "{";
    do {
      if (!has_rows) {
        numbers.texts.push_back(number());
        continue;
      }
      const std::size_t before = numbers.texts.size();
      take("{");
      do numbers.texts.push_back(number());
      while (takeComma());
      take("}");
      const std::size_t width = numbers.texts.size() - before;
      require(before == 0 || width == numbers.width, "a table of the code has rows of several lengths");
      numbers.width = width;
    } while (takeComma());
    take("}");
    return numbers;
  }

 private:
  const std::string& next() const {
    require(at_ < tokens_.size(), "the code ends early");
    return tokens_[at_];
  }
  void take(const std::string& token) {
    require(next() == token, "a table of the code has what is no number: " + next());
    ++at_;
  }
  bool takeComma() {
    if (next() != ",") return false;
    ++at_;
    return true;
  }
  std::string number() {
    std::string text;
    if (next() == "-") {
      text = "-";
      ++at_;
    }
    require(isDigit(next()[0]), "a table of the code has what is no number: " + next());
    return text + tokens_[at_++];
  }

  const std::vector<std::string>& tokens_;
  std::size_t& at_;
};

}  // namespace

CodeMatch matchCode(const std::string& text, const std::string& expected) {
  require(text.find('$') == std::string::npos, "the code has a $");
  const std::vector<std::string> found = Tokens(text).result, wanted = Tokens(expected).result;
  CodeMatch match;
  std::size_t at = 0;
  for (const std::string& token : wanted) {
    if (token[0] == '$') {
      match[token.substr(1)] = NumberReader(found, at).read();
      continue;
    }
    const std::string& other = at < found.size() ? found[at] : std::string("its end");
    const std::string before = at > 0 && at <= found.size() ? found[at - 1] : std::string("its begin");
    require(at < found.size() && other == token,
            "the text of the code is not that of an exported map: behind " + before + " it must have " +
                token + ", has " + other);
    ++at;
  }
  require(at == found.size(), "the text of the code does not end where that of an exported map does");
  return match;
}

std::string filledIn(std::string text, const std::map<std::string, std::string>& values) {
  for (std::size_t first = text.find('@'); first != std::string::npos; first = text.find('@', first)) {
    const std::size_t end = text.find('@', first + 1);
    require(end != std::string::npos, "a text of the checker has an open key");
    text.replace(first, end + 1 - first, values.at(text.substr(first + 1, end - first - 1)));
  }
  return text;
}

}  // namespace checker
