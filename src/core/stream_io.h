// Binary streams of vectors and arrays of plain data, for the state of techniques in checkpoints. Memory is copied as
// it is, so only the same machine and version can read it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <istream>
#include <limits>
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
namespace detail {
/// Reads a number of elements. Sets failbit and returns 0 if it exceeds `most`, or if the rest of the stream is
/// shorter. A damaged number therefore allocates no memory.
template <typename T>
uint64_t read_count(std::istream& in, uint64_t most) {
  static_assert(std::is_trivially_copyable_v<T>);
  uint64_t count = 0;
  read_value(in, count);
  const std::streamoff here = in.tellg();
  in.seekg(0, std::ios::end);
  const std::streamoff end = in.tellg();
  in.seekg(here);
  if (in && count <= most && count <= static_cast<uint64_t>(end - here) / sizeof(T)) return count;
  in.setstate(std::ios::failbit);
  return 0;
}

template <typename T>
void read_elements(std::istream& in, std::span<T> elements) {
  in.read(reinterpret_cast<char*>(elements.data()), static_cast<std::streamsize>(elements.size_bytes()));
}
}  // namespace detail

/// Reads what write_vector() wrote. A stream that ends early sets its failbit and leaves the vector empty. The stream
/// must be seekable.
template <typename T>
void read_vector(std::istream& in, std::vector<T>& v) {
  v = std::vector<T>(detail::read_count<T>(in, std::numeric_limits<uint64_t>::max()));
  detail::read_elements<T>(in, v);
  if (!in) v.clear();
}
/// Reads what write_array() wrote, without an intermediate copy. Also sets failbit if there are more than
/// Array<T>::kMaxSize elements.
template <typename T>
void read_array(std::istream& in, Array<T>& array) {
  array = Array<T>(array.memory());  // gives back the old elements' memory first
  array.reset(detail::read_count<T>(in, Array<T>::kMaxSize), kUninitialized);
  detail::read_elements(in, array.write());
  if (!in) array.clear();
}

}  // namespace relume
