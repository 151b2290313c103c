#include <cstring>
#include <limits>

#include <fmt/format.h>
#include <zlib.h>

#include "files/bytes.h"
#include "files/little_endian.h"
#include "relume/error.h"
#include "scene_io/mitsuba/mitsuba_meshes.h"

namespace relume::mitsuba {
namespace {

constexpr uint64_t kMagic = 0x041c;
constexpr size_t kMaxName = 4096;

constexpr uint32_t kNormals = 0x1;
constexpr uint32_t kTexcoords = 0x2;  // of versions 3 and 4
constexpr uint32_t kTangents = 0x2;   // of version 5
constexpr uint32_t kPackedTexcoords = 0x4;
constexpr uint32_t kColors = 0x8;
constexpr uint32_t kFaceNormals = 0x10;
constexpr uint32_t kDouble = 0x2000;

/// Decompresses a zlib stream piece by piece.
class Inflater {
 public:
  Inflater(std::span<const std::byte> data, const std::string& place, uint64_t& left) : place_(place), left_(left) {
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(data.data()));
    stream_.avail_in = static_cast<uInt>(std::min<size_t>(data.size(), std::numeric_limits<uInt>::max()));
    if (inflateInit(&stream_) != Z_OK) fail("it cannot be decompressed");
  }
  ~Inflater() { inflateEnd(&stream_); }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  void read(void* out, size_t bytes) {
    auto* next = static_cast<Bytef*>(out);
    while (bytes > 0) {
      const auto part = static_cast<uInt>(std::min<size_t>(bytes, size_t{1} << 30));
      stream_.next_out = next;
      stream_.avail_out = part;
      const int result = inflate(&stream_, Z_NO_FLUSH);
      const size_t written = part - stream_.avail_out;
      if (written == 0 || (result != Z_OK && result != Z_STREAM_END)) fail("it is cut off or damaged");
      next += written;
      bytes -= written;
    }
  }

  template <typename T>
  T number() {
    std::byte bytes[sizeof(T)];
    read(bytes, sizeof bytes);
    return static_cast<T>(detail::number_at(bytes, 0, sizeof(T)));
  }

  /// Reads `count` floats, or doubles as floats.
  std::vector<float> floats(uint64_t count, bool is_double) {
    check(count, is_double ? 8 : 4);
    std::vector<float> values(count);
    if (!is_double) {
      read(values.data(), values.size() * sizeof(float));
      return values;
    }
    for (float& value : values) {
      double wide = 0;
      read(&wide, sizeof wide);
      value = std::fabs(wide) > 3e38 ? kInfinity : static_cast<float>(wide);
    }
    return values;
  }

  std::vector<uint32_t> indices(uint64_t count) {
    check(count, 4);
    std::vector<uint32_t> values(count);
    read(values.data(), values.size() * sizeof(uint32_t));
    return values;
  }

  [[noreturn]] void fail(const std::string& problem) const {
    throw Error(fmt::format("{}: {}; export or copy the file again", place_, problem));
  }

 private:
  /// Throws Error before an allocation that the file cannot fill, or that is beyond the limits.
  void check(uint64_t count, uint64_t bytes) {
    if (count > left_ / bytes)
      fail(fmt::format("{} values do not fit into the file, which may decompress to {} more bytes", count, left_));
    left_ -= count * bytes;
  }

  const std::string& place_;
  uint64_t& left_;  ///< bytes that may still be decompressed
  z_stream stream_{};
};

std::vector<Vec3> triples(const std::vector<float>& values) {
  std::vector<Vec3> result(values.size() / 3);
  for (size_t i = 0; i < result.size(); ++i) result[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
  return result;
}

/// Numbers of vertices and triangles, below 2³².
std::pair<uint64_t, uint64_t> read_counts(Inflater& in) {
  const auto vertices = in.number<uint64_t>();
  const auto triangles = in.number<uint64_t>();
  if (vertices >> 32 != 0 || triangles >> 32 != 0) in.fail("it has more than 2^32 vertices or triangles");
  return {vertices, triangles};
}

Mesh read_separate(Inflater& in, uint64_t version) {
  const auto flags = in.number<uint32_t>();
  for (size_t i = 0; version == 4 && in.number<uint8_t>() != 0; ++i) {
    if (i > kMaxName) in.fail("its name does not end");
  }
  const auto [vertices, triangles] = read_counts(in);
  const bool is_double = (flags & kDouble) != 0;
  Mesh mesh;
  mesh.positions = triples(in.floats(3 * vertices, is_double));
  if (flags & kNormals) mesh.normals = triples(in.floats(3 * vertices, is_double));
  if (flags & kTexcoords) {
    const std::vector<float> uv = in.floats(2 * vertices, is_double);
    for (size_t i = 0; i < vertices; ++i) mesh.uv0.emplace_back(uv[2 * i], uv[2 * i + 1]);
  }
  if (flags & kColors) in.floats(3 * vertices, is_double);  // Mitsuba ignores them
  const std::vector<uint32_t> corners = in.indices(3 * triangles);
  for (size_t i = 0; i < triangles; ++i)
    mesh.triangles.emplace_back(corners[3 * i], corners[3 * i + 1], corners[3 * i + 2]);
  if (flags & kFaceNormals) mesh.normals.clear();
  return mesh;
}

/// Vertices of eight floats, triangles of four integers, then data that are not needed here.
Mesh read_packed(Inflater& in) {
  const auto flags = in.number<uint32_t>();
  const auto name_length = in.number<uint32_t>();
  if (name_length > kMaxName) in.fail("its name is too long");
  std::vector<char> name(name_length);
  in.read(name.data(), name.size());
  const auto [vertices, triangles] = read_counts(in);
  in.number<uint64_t>();  // surface points
  in.number<uint64_t>();  // groups of normals
  const bool has_normals = (flags & kNormals) != 0 && (flags & (kTangents | kFaceNormals)) == 0;
  Mesh mesh;
  const std::vector<float> records = in.floats(8 * vertices, false);
  for (size_t i = 0; i < vertices; ++i) {
    const float* r = &records[8 * i];
    mesh.positions.emplace_back(r[0], r[1], r[2]);
    if (has_normals) mesh.normals.emplace_back(r[3], r[4], r[5]);
    if (flags & kPackedTexcoords) mesh.uv0.emplace_back(r[6], r[7]);
  }
  const std::vector<uint32_t> corners = in.indices(4 * triangles);
  for (size_t i = 0; i < triangles; ++i)
    mesh.triangles.emplace_back(corners[4 * i], corners[4 * i + 1], corners[4 * i + 2]);
  return mesh;
}

}  // namespace

Mesh read_serialized(std::span<const std::byte> file, int64_t index, const std::string& place, uint64_t& inflatable) {
  const auto fail = [&](const std::string& problem) {
    throw Error(fmt::format("{}: {}; export or copy the file again", place, problem));
  };
  constexpr size_t kHead = 4;
  const auto number = [&](size_t at, size_t size) { return detail::number_at(file, at, size); };
  const uint64_t version = number(2, 2);
  if (file.size() < 2 * kHead || number(0, 2) != kMagic) fail("it is not in the serialized format of Mitsuba");
  if (version < 3 || version > 5) fail(fmt::format("version {} of the serialized format is not supported", version));
  size_t start = 0;
  if (index != 0) {
    const size_t entry = version == 3 ? 4 : 8;
    const uint64_t count = number(file.size() - 4, 4);
    if (index < 0 || static_cast<uint64_t>(index) >= count || count > file.size() / entry)
      fail(fmt::format("it has {} meshes, so that shape_index {} does not exist", count, index));
    start = number(file.size() - 4 - entry * (count - static_cast<uint64_t>(index)), entry);
    if (start + kHead > file.size() || start + kHead < start) fail("its list of meshes is damaged");
  }
  Inflater in(file.subspan(start + kHead), place, inflatable);
  Mesh mesh = version == 5 ? read_packed(in) : read_separate(in, version);
  if (mesh.triangles.empty()) fail("it has no triangles");
  return mesh;
}

}  // namespace relume::mitsuba
