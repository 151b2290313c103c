#include "scene_io/testing/serialized_file.h"

#include <initializer_list>

#include <zlib.h>

namespace relume::testing {
namespace {

void append_real(Bytes& bytes, double value, bool is_double) {
  if (is_double) {
    append_number(bytes, value);
  } else {
    append_number(bytes, static_cast<float>(value));
  }
}

void append(Bytes& bytes, const Bytes& more) { bytes.insert(bytes.end(), more.begin(), more.end()); }

/// Versions 3 and 4: one array per quantity.
Bytes separate_body(uint16_t version, double x) {
  const bool is_double = version == 4;
  Bytes body;
  append_number(body, is_double ? uint32_t{0x2002} : uint32_t{0x1002});
  if (version == 4) append_number(body, uint16_t{'a'});  // a name of one character and its zero
  append_number(body, uint64_t{3});
  append_number(body, uint64_t{1});
  for (const double value : {0.0, 0.0, 0.0, x, 0.0, 0.0, 0.0, 1.0, 0.0}) append_real(body, value, is_double);
  for (const double value : {0.25, 0.5, 0.25, 0.5, 0.25, 0.5}) append_real(body, value, is_double);
  for (const uint32_t corner : {0, 1, 2}) append_number(body, corner);
  return body;
}

/// Version 5: vertices of eight floats, triangles of four integers.
Bytes packed_body(double x) {
  Bytes body;
  append_number(body, uint32_t{0x1005});
  append_number(body, uint32_t{1});
  append_number(body, 'a');
  for (const uint64_t count : {3, 1, 0, 0}) append_number(body, count);
  const double positions[3][3] = {{0, 0, 0}, {x, 0, 0}, {0, 1, 0}};
  for (const auto& p : positions) {
    for (const double value : {p[0], p[1], p[2], 0.0, 0.0, 1.0, 0.25, 0.5}) append_real(body, value, false);
  }
  for (const uint32_t value : {0, 1, 2, 7}) append_number(body, value);
  return body;
}

}  // namespace

Bytes serialized_mesh(uint16_t version, const Bytes& body) {
  Bytes file;
  append_number(file, uint16_t{0x041c});
  append_number(file, version);
  uLongf size = compressBound(body.size());
  Bytes packed(size);
  compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(body.data()), body.size());
  packed.resize(size);
  append(file, packed);
  return file;
}

Bytes serialized_file(uint16_t version) {
  const auto mesh = [&](double x) {
    return serialized_mesh(version, version == 5 ? packed_body(x) : separate_body(version, x));
  };
  Bytes file = mesh(1);
  const uint64_t second = file.size();
  append(file, mesh(5));
  for (const uint64_t offset : {uint64_t{0}, second}) {
    if (version == 3) {
      append_number(file, static_cast<uint32_t>(offset));
    } else {
      append_number(file, offset);
    }
  }
  append_number(file, uint32_t{2});
  return file;
}

}  // namespace relume::testing
