// Records of the data structures that techniques maintain, for inspection: octree leaves, cells, quadtrees, light
// lists.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "relume/buffers.h"

namespace relume {

/// A member of a record: `count` numbers of one type.
struct RecordField {
  std::string name;
  ElementType type = ElementType::float32;
  uint32_t count = 1;
  size_t offset = 0;  ///< bytes from the beginning of the record
};

/// Describes a table of equal records.
struct RecordTable {
  std::string name;  ///< pass and part: "octree.leaves"
  std::string help;  ///< content of one record
  std::vector<RecordField> fields;
  size_t stride = 0;  ///< bytes per record
};

/// The records as of the last frame, in an order that does not depend on the number of threads.
struct RecordData {
  RecordTable table;
  std::vector<std::byte> bytes;

  size_t size() const { return bytes.size() / table.stride; }
};

}  // namespace relume
