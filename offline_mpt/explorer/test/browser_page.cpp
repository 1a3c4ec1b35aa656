#include "browser_page.hpp"

#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <sstream>

#include "polyfly_base/error.hpp"
#include "scratch_folder.hpp"

namespace polyfly {
namespace {

// The browser is ended after this time: it has met a page that never ends.
constexpr int kTimeLimit = 300;  // [s]

const char kFlags[] =
    " --headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking"
    " --disable-component-update --disable-sync --disable-dev-shm-usage --window-size=1400,900 --dump-dom";

std::string outputOf(const std::string& command) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(::popen(command.c_str(), "r"), ::pclose);
  if (!pipe) throw Error("cannot run " + command);
  std::string text;
  std::array<char, 65536> block;
  for (std::size_t got = 0; (got = std::fread(block.data(), 1, block.size(), pipe.get())) > 0;)
    text.append(block.data(), got);
  return text;
}

/// The text of an element as the browser writes it: three marks are escaped.
std::string unescape(std::string text) {
  const std::array<std::array<const char*, 2>, 4> kMarks = {
      {{"&lt;", "<"}, {"&gt;", ">"}, {"&nbsp;", "\xc2\xa0"}, {"&amp;", "&"}}};
  for (const auto& [escaped, mark] : kMarks) {
    const std::string from = escaped;
    std::string result;
    std::size_t begin = 0;
    for (std::size_t at = 0; (at = text.find(from, begin)) != std::string::npos; begin = at + from.size())
      result.append(text, begin, at - begin).append(mark);
    text = result.append(text, begin, std::string::npos);
  }
  return text;
}

}  // namespace

std::string chromiumProgram() {
  if (const char* chosen = std::getenv("POLYFLY_CHROMIUM")) return chosen;
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    const std::string program = folder + "/chromium";
    if (::access(program.c_str(), X_OK) == 0) return program;
  }
  return "";
}

nlohmann::json reportOf(const std::string& page, const std::string& view) {
  const ScratchFolder profile;
  const std::string text = outputOf("timeout " + std::to_string(kTimeLimit) + " '" + chromiumProgram() + "'" +
                                    kFlags + " --user-data-dir='" + profile.file("profile") + "' 'file://" +
                                    page + "#report&" + view + "' 2> /dev/null");
  const std::string begin = "<pre id=\"report\">";
  const std::size_t at = text.find(begin);
  const std::size_t end = at == std::string::npos ? at : text.find("</pre>", at);
  if (end == std::string::npos) throw Error(page + ": the browser shows no report");
  return nlohmann::json::parse(unescape(text.substr(at + begin.size(), end - at - begin.size())));
}

}  // namespace polyfly
