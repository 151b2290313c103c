// Makes files in Mitsuba's "serialized" format for tests.
#pragma once

#include <cstdint>
#include <cstring>

#include "files/bytes.h"

namespace relume::testing {

/// Appends the bytes of a number, little-endian.
template <typename T>
void append_number(Bytes& bytes, T value) {
  const size_t end = bytes.size();
  bytes.resize(end + sizeof value);
  std::memcpy(&bytes[end], &value, sizeof value);
}

/// A mesh whose compressed content is `body`, behind its header.
Bytes serialized_mesh(uint16_t version, const Bytes& body);

/// Two meshes of one triangle (0, 0, 0) (x, 0, 0) (0, 1, 0), x = 1 and x = 5, in version 3 (single precision), 4
/// (double precision) or 5 (packed, with normals +Z). All texture coordinates are (0.25, 0.5).
Bytes serialized_file(uint16_t version);

}  // namespace relume::testing
