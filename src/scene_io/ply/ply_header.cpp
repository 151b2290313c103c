#include "scene_io/ply/ply_header.h"

#include <algorithm>
#include <array>
#include <charconv>

#include <fmt/format.h>

#include "relume/error.h"

namespace relume::ply {
namespace {

constexpr size_t kMaxHeaderSize = 1 << 20;

struct TypeName {
  std::string_view name;
  Type type;
};

constexpr std::array<TypeName, 16> kTypeNames = {{{"char", Type::i8},
                                                  {"int8", Type::i8},
                                                  {"uchar", Type::u8},
                                                  {"uint8", Type::u8},
                                                  {"short", Type::i16},
                                                  {"int16", Type::i16},
                                                  {"ushort", Type::u16},
                                                  {"uint16", Type::u16},
                                                  {"int", Type::i32},
                                                  {"int32", Type::i32},
                                                  {"uint", Type::u32},
                                                  {"uint32", Type::u32},
                                                  {"float", Type::f32},
                                                  {"float32", Type::f32},
                                                  {"double", Type::f64},
                                                  {"float64", Type::f64}}};

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> words;
  while (!line.empty()) {
    const size_t start = line.find_first_not_of(" \t\r");
    if (start == std::string_view::npos) break;
    const size_t end = std::min(line.find_first_of(" \t\r", start), line.size());
    words.push_back(line.substr(start, end - start));
    line.remove_prefix(end);
  }
  return words;
}

class HeaderParser {
 public:
  explicit HeaderParser(const std::string& place) : place_(place) {}

  void parse_line(std::string_view line, Header& header) {
    const auto words = split(line);
    if (words.empty() || words[0] == "comment" || words[0] == "obj_info") return;
    if (words[0] == "format" && words.size() >= 2) {
      header.encoding = encoding(words[1]);
      has_format_ = true;
    } else if (words[0] == "element" && words.size() == 3) {
      header.elements.push_back({std::string(words[1]), count(words[2]), {}});
    } else if (words[0] == "property" && !header.elements.empty() && words.size() == 3) {
      header.elements.back().properties.push_back({std::string(words[2]), type(words[1])});
    } else if (words[0] == "property" && !header.elements.empty() && words.size() == 5 && words[1] == "list") {
      header.elements.back().properties.push_back({std::string(words[4]), type(words[3]), true, type(words[2])});
    } else {
      fail(fmt::format("the header line '{}' is not PLY", line.substr(0, 80)));
    }
  }

  void finish() const {
    if (!has_format_) fail("the header names no format");
  }

  [[noreturn]] void fail(const std::string& problem) const {
    throw Error(fmt::format("{}: {}; the file is damaged, export or copy it again", place_, problem));
  }

 private:
  Encoding encoding(std::string_view name) const {
    if (name == "ascii") return Encoding::ascii;
    if (name == "binary_little_endian") return Encoding::little_endian;
    if (name == "binary_big_endian") return Encoding::big_endian;
    fail(fmt::format("the format '{}' is unknown", name));
  }

  Type type(std::string_view name) const {
    const auto it =
        std::find_if(kTypeNames.begin(), kTypeNames.end(), [&](const TypeName& t) { return t.name == name; });
    if (it == kTypeNames.end()) fail(fmt::format("the type '{}' is unknown", name));
    return it->type;
  }

  uint64_t count(std::string_view text) const {
    uint64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size())
      fail(fmt::format("'{}' is not a number of elements", text));
    return value;
  }

  const std::string& place_;
  bool has_format_ = false;
};

}  // namespace

size_t size_of(Type type) {
  switch (type) {
    case Type::i8:
    case Type::u8: return 1;
    case Type::i16:
    case Type::u16: return 2;
    case Type::i32:
    case Type::u32:
    case Type::f32: return 4;
    case Type::f64: return 8;
  }
  return 0;
}

int Element::find(std::initializer_list<std::string_view> names) const {
  for (size_t i = 0; i < properties.size(); ++i) {
    if (std::find(names.begin(), names.end(), properties[i].name) != names.end()) return static_cast<int>(i);
  }
  return -1;
}

Header parse_header(std::string_view file, const std::string& place) {
  HeaderParser parser(place);
  Header header;
  if (!file.starts_with("ply")) parser.fail("it does not start with 'ply'");
  const std::string_view head = file.substr(0, kMaxHeaderSize);
  size_t offset = 0;
  for (int line_number = 0;; ++line_number) {
    const size_t end = head.find('\n', offset);
    if (end == std::string_view::npos) parser.fail("its header does not end");
    std::string_view line = head.substr(offset, end - offset);
    if (line.ends_with('\r')) line.remove_suffix(1);
    offset = end + 1;
    if (line == "end_header") break;
    if (line_number > 0) parser.parse_line(line, header);
  }
  parser.finish();
  header.size = offset;
  return header;
}

}  // namespace relume::ply
