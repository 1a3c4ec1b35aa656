#include <algorithm>
#include <array>
#include <limits>
#include <optional>

#include "autopilot/autopilot_log.hpp"
#include "log_bytes.hpp"

namespace polyfly {
namespace {

constexpr std::uint8_t kHead1 = 0xa3;
constexpr std::uint8_t kHead2 = 0x95;
constexpr std::size_t kHeader = 3;
constexpr std::uint8_t kFormatType = 128;
constexpr std::size_t kFormatLength = 89;
constexpr double kMicroseconds = 1e-6;
constexpr double kMilliseconds = 1e-3;

// What a letter of a format stands for.
struct Code {
  char letter;
  std::size_t size;
  double scale;  // 0: text or an array, no number
  char type;     // see numberAt
};
constexpr Code kCodes[] = {
    {'b', 1, 1.0, 'b'},  {'B', 1, 1.0, 'B'},  {'h', 2, 1.0, 'h'},  {'H', 2, 1.0, 'H'},  {'i', 4, 1.0, 'i'},
    {'I', 4, 1.0, 'I'},  {'f', 4, 1.0, 'f'},  {'d', 8, 1.0, 'd'},  {'c', 2, 0.01, 'h'}, {'C', 2, 0.01, 'H'},
    {'e', 4, 0.01, 'i'}, {'E', 4, 0.01, 'I'}, {'L', 4, 1e-7, 'i'}, {'M', 1, 1.0, 'B'},  {'q', 8, 1.0, 'q'},
    {'Q', 8, 1.0, 'Q'},  {'n', 4, 0.0, 's'},  {'N', 16, 0.0, 's'}, {'Z', 64, 0.0, 's'}, {'a', 64, 0.0, 's'}};

struct Field {
  std::string name;
  char letter = 'B';
  char type = 'B';
  // Offset from the end of the message header [bytes].
  std::size_t offset = 0;
  double scale = 1.0;
};

// Where a row's time stands.
struct Clock {
  char type = 'Q';
  // Offset from the end of the message header [bytes].
  std::size_t offset = 0;
  // Factor from the logged unit to seconds. 0: the format has no time.
  double scale = 0.0;
};

struct Format {
  std::string name;
  // Length of the message, header included [bytes].
  std::size_t length = 0;
  std::vector<Field> fields;
  Clock time;
  std::optional<Field> instance;
  bool keep = false;

  const Field* find(const std::string& wanted) const {
    const auto found = std::find_if(fields.begin(), fields.end(),
                                    [&wanted](const Field& field) { return field.name == wanted; });
    return found == fields.end() ? nullptr : &*found;
  }
};

std::string textAt(const std::uint8_t* data, std::size_t size) {
  const auto* text = reinterpret_cast<const char*>(data);
  return {text, static_cast<std::size_t>(std::find(text, text + size, '\0') - text)};
}

// Fields in the order of the format; none where letters and names do not fit or exceed the length.
std::optional<std::vector<Field>> fieldsOf(const std::string& letters, const std::string& names,
                                           std::size_t length) {
  std::vector<Field> fields;
  std::size_t offset = 0;
  std::size_t begin = 0;
  for (const char letter : letters) {
    const auto* code = std::find_if(std::begin(kCodes), std::end(kCodes),
                                    [letter](const Code& one) { return one.letter == letter; });
    if (code == std::end(kCodes) || begin > names.size()) return std::nullopt;
    const std::size_t end = std::min(names.find(',', begin), names.size());
    fields.push_back({names.substr(begin, end - begin), letter, code->type, offset, code->scale});
    begin = end + 1;
    offset += code->size;
  }
  if (kHeader + offset > length) return std::nullopt;
  return fields;
}

class Reader {
 public:
  Reader(const std::string& path, const std::vector<std::string>& wanted) : bytes_(path), wanted_(wanted) {
    log_.path = path;
    log_.kind = AutopilotLog::Kind::kDataflash;
    formats_[kFormatType].length = kFormatLength;
  }

  AutopilotLog read() {
    const std::uint8_t* begin = bytes_.peek(kHeader);
    if (begin == nullptr || begin[0] != kHead1 || begin[1] != kHead2) {
      throw Error(log_.path + ": is no dataflash log: it does not begin with a message's head");
    }
    while (readMessage()) {
    }
    finish();
    return std::move(log_);
  }

 private:
  bool readMessage() {
    const std::uint8_t* head = bytes_.peek(kHeader);
    if (head == nullptr) {
      cut_ = cut_ || bytes_.left() > 0;
      return false;
    }
    const Format& format = formats_[head[2]];
    if (head[0] != kHead1 || head[1] != kHead2 || format.length < kHeader) {
      bytes_.skip(1);
      ++skipped_;
      return true;
    }
    const std::uint8_t* whole = bytes_.peek(format.length);
    if (whole == nullptr) {
      cut_ = true;
      return false;
    }
    if (whole[2] == kFormatType) {
      addFormat(whole + kHeader);
    } else {
      addRow(format, whole + kHeader);
    }
    bytes_.skip(format.length);
    return true;
  }

  void addFormat(const std::uint8_t* data) {
    constexpr std::size_t kNameAt = 2;
    constexpr std::size_t kLettersAt = 6;
    constexpr std::size_t kNamesAt = 22;
    Format format;
    const std::uint8_t type = data[0];
    format.length = data[1];
    format.name = textAt(data + kNameAt, kLettersAt - kNameAt);
    const auto fields = fieldsOf(textAt(data + kLettersAt, kNamesAt - kLettersAt),
                                 textAt(data + kNamesAt, kFormatLength - kHeader - kNamesAt), format.length);
    if (type == kFormatType) return;  // describes itself
    if (!fields || format.length < kHeader) {
      ++damaged_;
      // Its length still tells where the next message begins.
      if (format.length >= kHeader) formats_[type] = format;
      return;
    }
    format.fields = *fields;
    for (const Field& field : format.fields) {
      if (field.scale == 0.0) continue;
      if (field.name == "TimeUS") format.time = {field.type, field.offset, kMicroseconds};
      if (field.name == "TimeMS") format.time = {field.type, field.offset, kMilliseconds};
      // The instance of a sensor, or the core of an estimator, in logs that do not tell it by FMTU.
      const bool core = field.name == "C" && format.name.compare(0, 2, "XK") == 0;
      // A controller's integral is called I too, but is no byte.
      if ((field.name == "I" && field.letter == 'B') || core) format.instance = field;
    }
    // A GPS that tells the week gives the time in it; the autopilot's own is T, where there is one.
    if (format.name == "GPS" && format.find("TimeMS") != nullptr && format.find("Week") != nullptr) {
      const Field* own = format.find("T");
      format.time = own != nullptr ? Clock{own->type, own->offset, own->scale * kMilliseconds} : Clock{};
    }
    format.keep = format.time.scale > 0.0 && (wanted_.empty() || std::find(wanted_.begin(), wanted_.end(),
                                                                           format.name) != wanted_.end());
    formats_[type] = std::move(format);
  }

  // FMTU gives a unit to each field of another format; `#` stands at the number of the instance.
  void addUnits(const Format& format, const std::uint8_t* data) {
    const Field* type = format.find("FmtType");
    const Field* units = format.find("UnitIds");
    constexpr std::size_t kUnits = 16;
    if (type == nullptr || type->letter != 'B' || units == nullptr || units->letter != 'N') return;
    Format& described = formats_[data[type->offset]];
    const std::size_t place = textAt(data + units->offset, kUnits).find('#');
    if (place >= described.fields.size() || described.fields[place].scale == 0.0) return;
    described.instance = described.fields[place];
  }

  void addRow(const Format& format, const std::uint8_t* data) {
    if (format.name == "FMTU") addUnits(format, data);
    std::string name = format.name;
    if (format.instance) {
      const double instance = numberAt(data + format.instance->offset, format.instance->type);
      if (instance > 0.0) name += "[" + std::to_string(static_cast<int>(instance)) + "]";
    }
    ++log_.counts[name];
    if (!format.keep) return;
    LogTable& table = log_.tables[name];
    table.time.push_back(format.time.scale * numberAt(data + format.time.offset, format.time.type));
    for (const Field& field : format.fields) {
      if (field.scale == 0.0) continue;
      addValue(field.name, field.scale * numberAt(data + field.offset, field.type), &table);
    }
  }

  void finish() {
    if (log_.counts.empty()) throw Error(log_.path + ": holds no message that a format describes");
    fillColumns(&log_);
    log_.lossy = cut_ || skipped_ > 0 || damaged_ > 0;
    if (cut_) log_.remarks.push_back("the last message was cut off");
    if (skipped_ > 0)
      log_.remarks.push_back(std::to_string(skipped_) + " bytes between messages were skipped");
    if (damaged_ > 0)
      log_.remarks.push_back(std::to_string(damaged_) + " formats are damaged; their messages were left out");
  }

  LogBytes bytes_;
  std::vector<std::string> wanted_;
  AutopilotLog log_;
  std::array<Format, 256> formats_;
  bool cut_ = false;
  std::size_t skipped_ = 0;  // [bytes]
  std::size_t damaged_ = 0;
};

}  // namespace

bool isDataflash(const std::string& path) { return beginsWith(path, {kHead1, kHead2}); }

AutopilotLog readDataflash(const std::string& path, const std::vector<std::string>& wanted) {
  return Reader(path, wanted).read();
}

}  // namespace polyfly
