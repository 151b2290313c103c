// Parses the header of a PLY file.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace relume::ply {

enum class Encoding : uint8_t { ascii, little_endian, big_endian };
enum class Type : uint8_t { i8, u8, i16, u16, i32, u32, f32, f64 };

/// Size in a binary file, in bytes.
size_t size_of(Type type);

struct Property {
  std::string name;
  Type type = Type::f32;
  bool is_list = false;
  Type count_type = Type::u8;  ///< type of a list's length
};

struct Element {
  std::string name;
  uint64_t count = 0;
  std::vector<Property> properties;

  /// Index in `properties` of the first of these names; -1 if none exists.
  int find(std::initializer_list<std::string_view> names) const;
};

struct Header {
  Encoding encoding = Encoding::ascii;
  std::vector<Element> elements;
  size_t size = 0;  ///< bytes up to and including the line of "end_header"
};

/// Parses the header at the start of `file`. Throws Error with `place`.
Header parse_header(std::string_view file, const std::string& place);

}  // namespace relume::ply
