// Binary streams of vectors and arrays of plain data, for the state of techniques in checkpoints. Memory is copied as
// it is, so only the same machine and version can read it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <istream>
#include <ostream>
#include <span>
#include <type_traits>
#include <vector>

#include "core/array.h"

namespace relume {

template <typename T>
void write_value(std::ostream& out, const T& value) {
  static_assert(std::is_trivially_copyable_v<T>);
  out.write(reinterpret_cast<const char*>(&value), sizeof(T));
}
template <typename T>
void read_value(std::istream& in, T& value) {
  static_assert(std::is_trivially_copyable_v<T>);
  in.read(reinterpret_cast<char*>(&value), sizeof(T));
}

namespace detail {
template <typename T>
void write_elements(std::ostream& out, std::span<const T> v) {
  static_assert(std::is_trivially_copyable_v<T>);
  write_value(out, static_cast<uint64_t>(v.size()));
  out.write(reinterpret_cast<const char*>(v.data()), static_cast<std::streamsize>(v.size_bytes()));
}
}  // namespace detail

template <typename T>
void write_vector(std::ostream& out, const std::vector<T>& v) {
  detail::write_elements<T>(out, v);
}
template <typename T>
void write_array(std::ostream& out, const Array<T>& array) {
  detail::write_elements<T>(out, array.read());
}
/// A stream that ends early, or declares more than 64 GiB, sets its failbit and leaves the vector empty.
template <typename T>
void read_vector(std::istream& in, std::vector<T>& v) {
  static_assert(std::is_trivially_copyable_v<T>);
  constexpr uint64_t kMaxBytes = uint64_t{1} << 36;
  uint64_t size = 0;
  read_value(in, size);
  v.clear();
  if (!in || size > kMaxBytes / sizeof(T)) {
    in.setstate(std::ios::failbit);
    return;
  }
  // Reads in pieces, so that a false size does not allocate more memory than the stream can fill.
  constexpr uint64_t kPiece = uint64_t{1} << 20;
  while (v.size() < size && in) {
    const uint64_t count = size - v.size() < kPiece ? size - v.size() : kPiece;
    const size_t old = v.size();
    v.resize(old + count);
    in.read(reinterpret_cast<char*>(v.data() + old), static_cast<std::streamsize>(count * sizeof(T)));
  }
  if (!in) v.clear();
}
/// The same for an array.
template <typename T>
void read_array(std::istream& in, Array<T>& array) {
  std::vector<T> elements;
  read_vector(in, elements);
  array.assign(elements);
}

}  // namespace relume
