// The header of a PLY file.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace relume::ply {

enum class Encoding : uint8_t { ascii, little_endian, big_endian };
enum class Type : uint8_t { i8, u8, i16, u16, i32, u32, f32, f64 };

/// Bytes of a number in a binary file.
size_t size_of(Type type);

struct Property {
  std::string name;
  Type type = Type::f32;
  bool is_list = false;
  Type count_type = Type::u8;  ///< of a list
};

struct Element {
  std::string name;
  uint64_t count = 0;
  std::vector<Property> properties;

  /// Index in `properties`; -1 if there is none of these names.
  int find(std::initializer_list<std::string_view> names) const;
};

struct Header {
  Encoding encoding = Encoding::ascii;
  std::vector<Element> elements;
  size_t size = 0;  ///< bytes up to and including "end_header" and its line end
};

/// Throws Error with `place`.
Header parse_header(std::string_view file, const std::string& place);

}  // namespace relume::ply
