// Results of an experiment's parts as bytes, for ranks of the same version on processors of the same byte order.
//
// A result is plain data, text, an image, a vector, pair or optional value of results, or a type with a function
// members_of(const T*) beside it, which returns a tuple of pointers to all members.
#pragma once

#include <concepts>
#include <cstdint>
#include <istream>
#include <optional>
#include <ostream>
#include <sstream>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/stream_io.h"
#include "relume/error.h"
#include "relume/image.h"

namespace relume {

constexpr auto members_of(const Image*) { return std::tuple(&Image::width, &Image::height, &Image::pixels); }

namespace part_bytes {

template <typename T>
inline constexpr bool kIsVector = false;
template <typename T>
inline constexpr bool kIsVector<std::vector<T>> = true;
template <typename T>
inline constexpr bool kIsPair = false;
template <typename A, typename B>
inline constexpr bool kIsPair<std::pair<A, B>> = true;
template <typename T>
inline constexpr bool kIsOptional = false;
template <typename T>
inline constexpr bool kIsOptional<std::optional<T>> = true;

template <typename T>
void write(std::ostream& out, const T& value) {
  if constexpr (std::is_trivially_copyable_v<T>) {
    write_value(out, value);
  } else if constexpr (std::same_as<T, std::string>) {
    write_vector(out, std::vector<char>(value.begin(), value.end()));
  } else if constexpr (kIsVector<T>) {
    if constexpr (std::is_trivially_copyable_v<typename T::value_type>) {
      write_vector(out, value);
    } else {
      write_value(out, uint64_t{value.size()});
      for (const auto& element : value) write(out, element);
    }
  } else if constexpr (kIsPair<T>) {
    write(out, value.first);
    write(out, value.second);
  } else if constexpr (kIsOptional<T>) {
    write_value(out, uint8_t{value.has_value()});
    if (value) write(out, *value);
  } else {
    std::apply([&](auto... members) { (write(out, value.*members), ...); }, members_of(&value));
  }
}

template <typename T>
void read(std::istream& in, T& value) {
  if constexpr (std::is_trivially_copyable_v<T>) {
    read_value(in, value);
  } else if constexpr (std::same_as<T, std::string>) {
    std::vector<char> text;
    read_vector(in, text);
    value.assign(text.begin(), text.end());
  } else if constexpr (kIsVector<T>) {
    if constexpr (std::is_trivially_copyable_v<typename T::value_type>) {
      read_vector(in, value);
    } else {
      uint64_t count = 0;
      read_value(in, count);
      value.clear();
      for (uint64_t i = 0; i < count && in; ++i) read(in, value.emplace_back());
    }
  } else if constexpr (kIsPair<T>) {
    read(in, value.first);
    read(in, value.second);
  } else if constexpr (kIsOptional<T>) {
    uint8_t has_value = 0;
    read_value(in, has_value);
    value.reset();
    if (in && has_value != 0) read(in, value.emplace());
  } else {
    std::apply([&](auto... members) { (read(in, value.*members), ...); }, members_of(&std::as_const(value)));
  }
}

}  // namespace part_bytes

template <typename T>
std::string part_to_bytes(const T& value) {
  std::ostringstream out;
  part_bytes::write(out, value);
  return out.str();
}

/// Throws Error if the bytes end early.
template <typename T>
T part_from_bytes(const std::string& bytes) {
  std::istringstream in(bytes);
  T value{};
  part_bytes::read(in, value);
  if (!in) throw Error("a result of another rank is incomplete; give all ranks the same version of relume");
  return value;
}

}  // namespace relume
