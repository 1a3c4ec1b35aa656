#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <optional>

#include "autopilot/autopilot_log.hpp"
#include "log_bytes.hpp"
#include "ulog_message.hpp"

namespace polyfly {
namespace {

constexpr std::array<std::uint8_t, 7> kMagic = {0x55, 0x4c, 0x6f, 0x67, 0x01, 0x12, 0x35};
constexpr std::size_t kFileHeader = 16;
constexpr std::size_t kMessageHeader = 3;
constexpr std::size_t kLongestMessage = kMessageHeader + 0xffff;
// Greatest number of fields of one message. More fields mean damage.
constexpr std::size_t kMostFields = 4096;
// Greatest nesting depth of formats.
constexpr std::size_t kMostNesting = 8;
// Greatest number of layouts in a file.
constexpr std::size_t kMostLayouts = 100000;
// Greatest number of data messages in a row whose size no format tells. More of them mean damage.
constexpr std::size_t kMostUntold = 16;
constexpr double kMicroseconds = 1e-6;

struct Primitive {
  const char* name;
  char type;  // see numberAt; c: a letter of a text
  std::size_t size;
};
constexpr Primitive kPrimitives[] = {{"int8_t", 'b', 1},   {"uint8_t", 'B', 1},  {"int16_t", 'h', 2},
                                     {"uint16_t", 'H', 2}, {"int32_t", 'i', 4},  {"uint32_t", 'I', 4},
                                     {"int64_t", 'q', 8},  {"uint64_t", 'Q', 8}, {"float", 'f', 4},
                                     {"double", 'd', 8},   {"bool", 'B', 1},     {"char", 'c', 1}};

// Where a number lies in a message.
struct Field {
  std::string name;
  char type = 'B';
  std::size_t offset = 0;
  std::size_t size = 0;
};

// A subscription: messages of one format under one number.
struct Subscription {
  std::string table;
  std::vector<Field> fields;         // without text and padding; empty where it is not wanted
  std::optional<std::size_t> stamp;  // offset of the timestamp
  // Size of a row, without and with the padding at its end [bytes]. 0: the format does not tell.
  std::size_t least = 0;
  std::size_t greatest = 0;
};

// What the bytes at some place are by type, size and content. A message bears no mark and no checksum.
enum class Form {
  kNone,    // no message begins here
  kUntold,  // a data message whose size no format tells
  kWhole,   // a message
  kCut      // a message, as far as the file goes
};

class Reader {
 public:
  Reader(const std::string& path, const std::vector<std::string>& wanted) : bytes_(path), wanted_(wanted) {
    log_.path = path;
    log_.kind = AutopilotLog::Kind::kULog;
  }

  AutopilotLog read() {
    const std::uint8_t* header = bytes_.peek(kFileHeader);
    if (header == nullptr || !std::equal(kMagic.begin(), kMagic.end(), header)) {
      throw Error(log_.path + ": is no ULog: it does not begin with ULog's mark");
    }
    bytes_.skip(kFileHeader);
    while (readMessage()) {
    }
    finish();
    return std::move(log_);
  }

 private:
  // A message counts where another one follows, or the file ends: a lost byte shifts what is behind it. Else the next
  // one is searched for.
  bool readMessage() {
    if (bytes_.peek(kMessageHeader) == nullptr) {
      run_ += bytes_.left();
      cut_ = run_ > 0;
      if (run_ > kLongestMessage) {
        unread_ += run_;
        ++holes_;
      }
      return false;
    }
    const Form form = formAt(0);
    // What is searched for must bear its own size.
    const bool counts = form == Form::kWhole || (form == Form::kUntold && run_ == 0);
    if (!counts || !isFollowed(form)) {
      bytes_.skip(1);
      ++run_;
      return true;
    }
    if (run_ > 0) ++holes_;
    unread_ += run_;
    run_ = 0;
    const auto size = sizeAt(bytes_.peek(kMessageHeader));
    const std::uint8_t* whole = bytes_.peek(kMessageHeader + size);
    handle(static_cast<char>(whole[2]), whole + kMessageHeader, size);
    bytes_.skip(kMessageHeader + size);
    return true;
  }

  static std::size_t sizeAt(const std::uint8_t* head) { return readNumber<std::uint16_t>(head); }

  // `offset` from the current place.
  Form formAt(std::size_t offset) {
    const std::uint8_t* head = bytes_.peek(offset + kMessageHeader);
    if (head == nullptr) return Form::kCut;
    head += offset;
    const std::size_t size = sizeAt(head);
    const char type = static_cast<char>(head[2]);
    constexpr const char* kTypes = "BFIPMQARDLCSO";
    if (type == '\0' || std::strchr(kTypes, type) == nullptr) return Form::kNone;
    const std::uint8_t* whole = bytes_.peek(offset + kMessageHeader + size);
    if (whole == nullptr) return Form::kCut;
    const std::uint8_t* data = whole + offset + kMessageHeader;
    if (type != 'D') return isULogMessage(type, data, size) ? Form::kWhole : Form::kNone;
    constexpr std::size_t kHead = 2;
    if (size < kHead) return Form::kNone;
    const auto found = subscriptions_.find(readNumber<std::uint16_t>(data));
    const bool told = found != subscriptions_.end() && found->second.least <= size - kHead &&
                      size - kHead <= found->second.greatest;
    return told ? Form::kWhole : Form::kUntold;
  }

  // Whether another message, or the file's end, follows the one here.
  bool isFollowed(Form form) {
    std::size_t offset = 0;
    for (std::size_t untold = form == Form::kUntold ? 1 : 0; untold <= kMostUntold; ++untold) {
      const std::uint8_t* head = bytes_.peek(offset + kMessageHeader);
      offset += kMessageHeader + sizeAt(head + offset);
      const Form next = formAt(offset);
      if (next != Form::kUntold) return next != Form::kNone;
    }
    return false;
  }

  void handle(char type, const std::uint8_t* data, std::size_t size) {
    switch (type) {
      case 'B':
        checkFlags(data, size);
        break;
      case 'F':
        addFormat(std::string(reinterpret_cast<const char*>(data), size));
        break;
      case 'A':
        subscribe(data, size);
        break;
      case 'D':
        addRow(data, size);
        break;
      case 'O':
        if (size >= 2) lost_ += readNumber<std::uint16_t>(data);
        break;
      default:  // texts, parameters, marks for synchronisation, and what later versions add
        break;
    }
  }

  // A flag that is not known may change how the rest must be read.
  void checkFlags(const std::uint8_t* data, std::size_t size) {
    constexpr std::size_t kCompatible = 8;
    constexpr std::size_t kFlags = 16;
    for (std::size_t index = kCompatible; index < std::min(kFlags, size); ++index) {
      const std::uint8_t known = index == kCompatible ? 1 : 0;  // data appended after the end
      if ((data[index] & ~known) != 0)
        throw Error(log_.path + ": needs features of ULog that this reader lacks");
    }
  }

  void addFormat(const std::string& text) {
    const std::size_t colon = text.find(':');
    if (colon == std::string::npos) {
      ++damaged_;
      return;
    }
    formats_[text.substr(0, colon)] = text.substr(colon + 1);
  }

  // Appends the fields of a format, those of formats in it too; the size of all, none where it is damaged.
  std::optional<std::size_t> layout(const std::string& format, const std::string& prefix, std::size_t offset,
                                    std::size_t depth, Subscription* subscription) {
    const auto found = formats_.find(format);
    // Counted, because formats in arrays of formats multiply even where they hold no number.
    if (found == formats_.end() || depth > kMostNesting || ++layouts_ > kMostLayouts) return std::nullopt;
    const std::string& text = found->second;
    std::size_t begin = 0;
    while (begin < text.size()) {
      const std::size_t end = std::min(text.find(';', begin), text.size());
      const std::string entry = text.substr(begin, end - begin);
      begin = end + 1;
      const std::size_t space = entry.find(' ');
      if (entry.empty()) continue;
      if (space == std::string::npos) return std::nullopt;
      const auto next =
          addField(entry.substr(0, space), prefix + entry.substr(space + 1), offset, depth, subscription);
      if (!next) return std::nullopt;
      offset = *next;
    }
    return offset;
  }

  std::optional<std::size_t> addField(std::string type, const std::string& name, std::size_t offset,
                                      std::size_t depth, Subscription* subscription) {
    std::size_t count = 1;
    const std::size_t bracket = type.find('[');
    const bool array = bracket != std::string::npos;
    if (array) {
      const long entries = std::strtol(type.c_str() + bracket + 1, nullptr, 10);
      if (entries < 1 || entries > static_cast<long>(kMostFields)) return std::nullopt;
      count = static_cast<std::size_t>(entries);
      type.resize(bracket);
    }
    const auto* primitive = std::find_if(std::begin(kPrimitives), std::end(kPrimitives),
                                         [&type](const Primitive& one) { return type == one.name; });
    for (std::size_t index = 0; index < count; ++index) {
      const std::string full = array ? name + "[" + std::to_string(index) + "]" : name;
      if (primitive == std::end(kPrimitives)) {
        const auto next = layout(type, full + ".", offset, depth + 1, subscription);
        if (!next) return std::nullopt;
        offset = *next;
        continue;
      }
      const bool number = primitive->type != 'c' && name.compare(0, 8, "_padding") != 0;
      if (full == "timestamp" && primitive->type == 'Q') subscription->stamp = offset;
      if (number) subscription->fields.push_back({full, primitive->type, offset, primitive->size});
      if (subscription->fields.size() > kMostFields) return std::nullopt;
      offset += primitive->size;
      if (name.compare(0, 8, "_padding") != 0) subscription->least = offset;
    }
    return offset;
  }

  void subscribe(const std::uint8_t* data, std::size_t size) {
    constexpr std::size_t kHead = 3;
    if (size <= kHead) {
      ++damaged_;
      return;
    }
    const std::uint8_t instance = data[0];
    const auto id = readNumber<std::uint16_t>(data + 1);
    const std::string name(reinterpret_cast<const char*>(data) + kHead, size - kHead);
    Subscription subscription;
    subscription.table = instance == 0 ? name : name + "[" + std::to_string(instance) + "]";
    const bool keep = wanted_.empty() || std::find(wanted_.begin(), wanted_.end(), name) != wanted_.end();
    subscription.greatest = layout(name, "", 0, 0, &subscription).value_or(0);
    const bool described = subscription.greatest > 0 && subscription.stamp;
    if (keep && !described) ++damaged_;
    if (!keep || !described) subscription.fields.clear();
    subscriptions_[id] = std::move(subscription);
  }

  void addRow(const std::uint8_t* data, std::size_t size) {
    constexpr std::size_t kHead = 2;
    const auto found =
        size < kHead ? subscriptions_.end() : subscriptions_.find(readNumber<std::uint16_t>(data));
    if (found == subscriptions_.end()) {
      ++unknown_;
      return;
    }
    const Subscription& subscription = found->second;
    ++log_.counts[subscription.table];
    if (subscription.fields.empty()) return;
    const Field& last = subscription.fields.back();
    if (size - kHead < std::max(last.offset + last.size, *subscription.stamp + sizeof(std::uint64_t))) {
      ++damaged_;
      return;
    }
    LogTable& table = log_.tables[subscription.table];
    const std::uint8_t* row = data + kHead;
    table.time.push_back(kMicroseconds *
                         static_cast<double>(readNumber<std::uint64_t>(row + *subscription.stamp)));
    for (const Field& field : subscription.fields) {
      // A message that is described anew may have other fields.
      addValue(field.name, numberAt(row + field.offset, field.type), &table);
    }
  }

  void finish() {
    if (log_.counts.empty()) throw Error(log_.path + ": holds no data message");
    fillColumns(&log_);
    log_.lossy = cut_ || unread_ > 0 || damaged_ > 0 || unknown_ > 0 || lost_ > 0;
    if (cut_) log_.remarks.push_back("the last message was cut off");
    const auto tell = [this](std::size_t count, const char* what) {
      if (count > 0) log_.remarks.push_back(std::to_string(count) + what);
    };
    tell(lost_, " ms of messages were lost while logging");
    tell(damaged_, " messages are not what their format says and were left out");
    tell(unknown_, " data messages belong to no subscription and were left out");
    tellUnread();
  }

  // As of a bag, the share is never rounded up to 100 %.
  void tellUnread() {
    if (unread_ == 0) return;
    const auto all = static_cast<double>(bytes_.place() + bytes_.left());
    std::array<char, 160> text{};
    std::snprintf(text.data(), text.size(),
                  "%llu bytes in %zu places are no message: %.4g %% of the file were read",
                  static_cast<unsigned long long>(unread_), holes_,
                  std::floor(1e3 * (1.0 - static_cast<double>(unread_) / all)) / 10.0);
    log_.remarks.emplace_back(text.data());
  }

  LogBytes bytes_;
  std::vector<std::string> wanted_;
  AutopilotLog log_;
  std::map<std::string, std::string> formats_;
  std::map<std::uint16_t, Subscription> subscriptions_;
  std::size_t layouts_ = 0;
  std::size_t lost_ = 0;     // [ms]
  std::size_t damaged_ = 0;  // messages
  std::size_t unknown_ = 0;
  std::size_t run_ = 0;       // bytes since the last message
  std::uint64_t unread_ = 0;  // bytes between messages
  std::size_t holes_ = 0;
  bool cut_ = false;
};

}  // namespace

bool isULog(const std::string& path) { return beginsWith(path, {kMagic.begin(), kMagic.end()}); }

AutopilotLog readULog(const std::string& path, const std::vector<std::string>& wanted) {
  return Reader(path, wanted).read();
}

}  // namespace polyfly
