// Tables of records that a pass offers for inspection.
#pragma once

#include <algorithm>
#include <functional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/vec.h"
#include "relume/records.h"

namespace relume {

/// A table, and the function that copies its records.
struct PassRecords {
  RecordTable table;
  std::function<std::vector<std::byte>()> read;
};

/// Describes a member of a record: a float, an uint32_t or a vector of these.
template <typename Record, typename T>
RecordField record_field(const char* name, T Record::*member) {
  constexpr bool is_integer = std::is_same_v<T, uint32_t> || std::is_same_v<T, UVec2> || std::is_same_v<T, UVec3>;
  static_assert(is_integer || std::is_same_v<T, float> || std::is_same_v<T, Vec2> || std::is_same_v<T, Vec3>);
  const Record record{};
  const auto address = [](const auto& object) { return reinterpret_cast<const std::byte*>(&object); };
  return {.name = name,
          .type = is_integer ? ElementType::uint32 : ElementType::float32,
          .count = sizeof(T) / sizeof(uint32_t),
          .offset = static_cast<size_t>(address(record.*member) - address(record))};
}

/// A table named `name` with the records that `read` returns as a vector<Record>. It is called only for reading.
template <typename Record, typename F>
PassRecords pass_records(std::string name, std::string help, std::vector<RecordField> fields, F read) {
  static_assert(std::is_trivially_copyable_v<Record>);
  const auto read_bytes = [read = std::move(read)] {
    const std::vector<Record> records = read();
    const auto* bytes = reinterpret_cast<const std::byte*>(records.data());
    return std::vector<std::byte>(bytes, bytes + records.size() * sizeof(Record));
  };
  return {{std::move(name), std::move(help), std::move(fields), sizeof(Record)}, read_bytes};
}

}  // namespace relume
