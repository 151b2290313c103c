#include "serve/message.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "relume/error.h"
#include "serve/limits.h"

namespace relume::serve {
namespace {

using nlohmann::json;

constexpr int kMaxDepth = 1;       // of objects and arrays in the message
constexpr size_t kMaxFields = 8;   // no kind has more
constexpr size_t kMaxText = 1024;  // bytes
constexpr double kMaxDrag = 10;    // heights of the image
constexpr double kMaxNotches = 50;
constexpr double kMaxSide = 16384;  // pixels; the model limits sizes further
constexpr int kMaxSlot = 63;        // of bookmarks
constexpr double kMaxNumber = 4294967295.0;

/// The fields of a message. Each is read once, and all are.
class Fields {
 public:
  explicit Fields(const json& object) : object_(object) {}

  const std::string& text(const char* name) {
    const json& value = field(name);
    if (!value.is_string()) throw Error(fmt::format("{} is no text", name));
    const auto& text = value.get_ref<const std::string&>();
    if (text.size() > kMaxText) throw Error(fmt::format("{} is longer than {} bytes", name, kMaxText));
    return text;
  }
  double number(const char* name, double low, double high) {
    const json& value = field(name);
    if (!value.is_number()) throw Error(fmt::format("{} is no number", name));
    const auto number = value.get<double>();
    if (!(number >= low && number <= high)) throw Error(fmt::format("{} is not from {} to {}", name, low, high));
    return number;
  }
  float real(const char* name, double low, double high) { return static_cast<float>(number(name, low, high)); }
  double whole(const char* name, double low, double high) {
    const double value = number(name, low, high);
    if (value != std::floor(value)) throw Error(fmt::format("{} is no whole number", name));
    return value;
  }
  int integer(const char* name, int low, int high) { return static_cast<int>(whole(name, low, high)); }
  uint32_t count(const char* name) { return static_cast<uint32_t>(whole(name, 0, kMaxNumber)); }
  bool flag(const char* name) {
    const json& value = field(name);
    if (!value.is_boolean()) throw Error(fmt::format("{} is neither true nor false", name));
    return value.get<bool>();
  }
  /// Position of the field's text in `names`.
  template <size_t N>
  int choice(const char* name, const std::array<std::string_view, N>& names) {
    const auto found = std::find(names.begin(), names.end(), text(name));
    if (found == names.end()) throw Error(fmt::format("{} is none of the known ones", name));
    return static_cast<int>(found - names.begin());
  }
  bool has(const char* name) const { return object_.contains(name); }
  void require_all_read() const {
    if (read_ != object_.size()) throw Error("the message has unknown fields");
  }

 private:
  const json& field(const char* name) {
    const auto found = object_.find(name);
    if (found == object_.end()) throw Error(fmt::format("the message has no {}", name));
    ++read_;
    return *found;
  }

  const json& object_;
  size_t read_ = 0;
};

constexpr std::array<std::string_view, 10> kButtons = {"pause",   "home",   "split",    "orbit", "frame",
                                                       "animate", "darker", "brighter", "copy",  "swap"};
constexpr std::array<std::string_view, 3> kBookmarkVerbs = {"go", "store", "remove"};

using Reader = MessageBody (*)(Fields&);

MessageBody read_fly(Fields& f) {
  return Fly{{f.real("x", -1, 1), f.real("y", -1, 1), f.real("z", -1, 1)}, f.flag("fast")};
}

MessageBody read_drag(Fields& f) {
  return Drag{f.flag("pan"), {f.real("x", -kMaxDrag, kMaxDrag), f.real("y", -kMaxDrag, kMaxDrag)}};
}

MessageBody read_setting(Fields& f) { return ChangeSetting{f.integer("side", 0, 1), f.text("name"), f.text("value")}; }

MessageBody read_bookmark(Fields& f) {
  return UseBookmark{static_cast<BookmarkVerb>(f.choice("verb", kBookmarkVerbs)), f.integer("slot", 0, kMaxSlot)};
}

MessageBody read_resize(Fields& f) {
  return Resize{f.integer("width", 1, static_cast<int>(kMaxSide)), f.integer("height", 1, static_cast<int>(kMaxSide))};
}

const std::map<std::string, Reader, std::less<>>& readers() {
  static const std::map<std::string, Reader, std::less<>> all = {
      {"hello", [](Fields& f) -> MessageBody { return Hello{f.text("token")}; }},
      {"ack", [](Fields& f) -> MessageBody { return Acknowledge{f.count("frame")}; }},
      {"fly", read_fly},
      {"drag", read_drag},
      {"wheel", [](Fields& f) -> MessageBody { return Wheel{f.real("notches", -kMaxNotches, kMaxNotches)}; }},
      {"set", read_setting},
      {"preset",
       [](Fields& f) -> MessageBody {
         return ApplyPreset{f.integer("side", 0, 1), f.text("name")};
       }},
      {"buffer", [](Fields& f) -> MessageBody { return ShowBuffer{f.text("name")}; }},
      {"split-at", [](Fields& f) -> MessageBody { return MoveSplit{f.real("at", 0, 1)}; }},
      {"resize", read_resize},
      {"bookmark", read_bookmark},
      {"press", [](Fields& f) -> MessageBody { return Press{static_cast<Button>(f.choice("button", kButtons))}; }},
      {"screenshot", [](Fields&) -> MessageBody { return TakeScreenshot{}; }},
      {"steer", [](Fields&) -> MessageBody { return RequestSteering{}; }},
      {"grant", [](Fields& f) -> MessageBody { return GrantSteering{f.count("viewer")}; }},
      {"still", [](Fields&) -> MessageBody { return Still{}; }},
  };
  return all;
}

/// Parses JSON. Nesting is rejected while parsing, before its values take memory.
json parse(std::string_view text) {
  const auto check = [](int depth, json::parse_event_t event, json&) {
    const bool opens = event == json::parse_event_t::object_start || event == json::parse_event_t::array_start;
    if (opens && depth >= kMaxDepth) throw Error("the message is nested");
    return true;
  };
  try {
    return json::parse(text.begin(), text.end(), check);
  } catch (const json::exception&) {
    throw Error("the message is not valid JSON");
  }
}

}  // namespace

Message parse_message(std::string_view text) {
  if (text.size() > kMaxMessageBytes) throw Error(fmt::format("the message exceeds {} bytes", kMaxMessageBytes));
  // The parser would end there, and ignore the rest.
  if (text.find('\0') != std::string_view::npos) throw Error("the message has a zero byte");
  const json object = parse(text);
  if (!object.is_object()) throw Error("the message is no object");
  if (object.size() > kMaxFields) throw Error("the message has unknown fields");
  Fields fields(object);
  const auto reader = readers().find(fields.text("do"));
  if (reader == readers().end()) throw Error("the message is of an unknown kind");
  Message message;
  if (fields.has("n")) message.number = fields.count("n");
  message.body = reader->second(fields);
  fields.require_all_read();
  return message;
}

bool steers(const MessageBody& body) {
  return !std::holds_alternative<Hello>(body) && !std::holds_alternative<Acknowledge>(body) &&
         !std::holds_alternative<TakeScreenshot>(body) && !std::holds_alternative<RequestSteering>(body) &&
         !std::holds_alternative<Still>(body) && !std::holds_alternative<Left>(body);
}

}  // namespace relume::serve
