#include <gtest/gtest.h>

#include "scene_io/gltf/gltf_accessor.h"
#include "scene_io/testing/scene_files.h"

namespace relume {
namespace {

using testing::error_of;
using testing::GltfBuilder;
using testing::json;

/// Document of a builder's file. Owns its text.
struct Parsed {
  explicit Parsed(const GltfBuilder& file) : text(file.text()), document("test.gltf") {
    gltf::read_document(std::as_bytes(std::span(text)), "", document);
  }
  std::string text;
  gltf::Document document;
};

TEST(GltfAccessor, NormalisesEveryComponentType) {
  GltfBuilder file;
  const int i8 = file.accessor(std::vector<int8_t>{127, -127, -128, 0}, 1, 5120, true);
  const int u8 = file.accessor(std::vector<uint8_t>{255, 51, 0, 0}, 1, 5121, true);
  const int i16 = file.accessor(std::vector<int16_t>{32767, -32768}, 1, 5122, true);
  const int u16 = file.accessor(std::vector<uint16_t>{65535, 13107}, 1, 5123, true);
  const int u32 = file.accessor(std::vector<uint32_t>{7}, 1, 5125);
  const int f32 = file.floats({0.5f}, 1);
  const int plain = file.accessor(std::vector<int16_t>{-300, 300}, 1, 5122);
  const Parsed parsed(file);
  EXPECT_EQ(read_scalars(parsed.document, i8), (std::vector<float>{1, -1, -1, 0}));
  EXPECT_EQ(read_scalars(parsed.document, u8), (std::vector<float>{1, 0.2f, 0, 0}));
  EXPECT_EQ(read_scalars(parsed.document, i16), (std::vector<float>{1, -1}));
  EXPECT_EQ(read_scalars(parsed.document, u16), (std::vector<float>{1, 0.2f}));
  EXPECT_EQ(read_scalars(parsed.document, u32), (std::vector<float>{7}));
  EXPECT_EQ(read_scalars(parsed.document, f32), (std::vector<float>{0.5f}));
  EXPECT_EQ(read_scalars(parsed.document, plain), (std::vector<float>{-300, 300}));
}

TEST(GltfAccessor, FollowsStridesAndOffsets) {
  GltfBuilder file;
  const int view = file.view(std::vector<float>{9, 1, 2, 9, 3, 4, 9, 5, 6});
  file.doc["bufferViews"][static_cast<size_t>(view)]["byteStride"] = 12;
  const int accessor = file.add_accessor(view, 3, 2, 5126);
  file.doc["accessors"][static_cast<size_t>(accessor)]["byteOffset"] = 4;
  const Parsed parsed(file);
  EXPECT_EQ(read_vec2(parsed.document, accessor), (std::vector<Vec2>{{1, 2}, {3, 4}, {5, 6}}));
}

TEST(GltfAccessor, ReadsIndicesOfAllTypes) {
  GltfBuilder file;
  const int u8 = file.accessor(std::vector<uint8_t>{1, 255}, 1, 5121);
  const int u16 = file.accessor(std::vector<uint16_t>{1, 65535}, 1, 5123);
  const int u32 = file.accessor(std::vector<uint32_t>{1, 0xffffffffu}, 1, 5125);
  const int f32 = file.floats({1}, 1);
  const Parsed parsed(file);
  EXPECT_EQ(read_indices(parsed.document, u8), (std::vector<uint32_t>{1, 255}));
  EXPECT_EQ(read_indices(parsed.document, u16), (std::vector<uint32_t>{1, 65535}));
  EXPECT_EQ(read_indices(parsed.document, u32), (std::vector<uint32_t>{1, 0xffffffffu}));
  EXPECT_THROW(read_indices(parsed.document, f32), Error);
}

json sparse(int count, int indices, int index_type, int values) {
  return {{"count", count},
          {"indices", {{"bufferView", indices}, {"componentType", index_type}}},
          {"values", {{"bufferView", values}}}};
}

TEST(GltfAccessor, AppliesSparseValues) {
  GltfBuilder file;
  const int base = file.floats({1, 2, 3, 4}, 1);
  const int indices = file.view(std::vector<uint16_t>{1, 3});
  const int values = file.view(std::vector<float>{20, 40});
  file.doc["accessors"][static_cast<size_t>(base)]["sparse"] = sparse(2, indices, 5123, values);
  const int zeros = file.add(
      "accessors",
      {{"count", 4}, {"type", "SCALAR"}, {"componentType", 5126}, {"sparse", sparse(2, indices, 5123, values)}});
  const int plain_zeros = file.add("accessors", {{"count", 3}, {"type", "VEC3"}, {"componentType", 5126}});
  const int beyond = file.add(
      "accessors",
      {{"count", 2}, {"type", "SCALAR"}, {"componentType", 5126}, {"sparse", sparse(2, indices, 5123, values)}});
  const int truncated = file.add(
      "accessors",
      {{"count", 4}, {"type", "SCALAR"}, {"componentType", 5126}, {"sparse", sparse(3, indices, 5123, values)}});
  const Parsed parsed(file);
  EXPECT_EQ(read_scalars(parsed.document, base), (std::vector<float>{1, 20, 3, 40}));
  EXPECT_EQ(read_scalars(parsed.document, zeros), (std::vector<float>{0, 20, 0, 40}));
  EXPECT_EQ(read_vec3(parsed.document, plain_zeros), std::vector<Vec3>(3, Vec3(0)));
  EXPECT_THROW(read_scalars(parsed.document, beyond), Error);
  EXPECT_THROW(read_scalars(parsed.document, truncated), Error);
}

TEST(GltfAccessor, RejectsAccessorsBeyondTheirBuffer) {
  GltfBuilder file;
  const int view = file.view(std::vector<float>{1, 2, 3, 4});
  const int fits = file.add_accessor(view, 4, 1, 5126);
  const int long_by_one = file.add_accessor(view, 5, 1, 5126);
  const int absurd = file.add_accessor(view, 0x7fffffffffffffffu, 4, 5126);
  const int shifted = file.add_accessor(view, 4, 1, 5126);
  file.doc["accessors"][static_cast<size_t>(shifted)]["byteOffset"] = 4;
  const int far = file.add_accessor(view, 1, 1, 5126);
  file.doc["accessors"][static_cast<size_t>(far)]["byteOffset"] = 0xfffffffffffffffcu;
  const int no_view = file.add_accessor(77, 1, 1, 5126);
  const int zeros = file.add("accessors", {{"count", 1u << 30}, {"type", "VEC4"}, {"componentType", 5126}});
  const Parsed parsed(file);
  EXPECT_EQ(read_scalars(parsed.document, fits).size(), 4u);
  for (const int bad : {long_by_one, shifted, far, no_view, 99, -1})
    EXPECT_THROW(read_scalars(parsed.document, bad), Error) << bad;
  for (const int bad : {absurd, zeros}) EXPECT_THROW(read_vec4(parsed.document, bad), Error) << bad;
  EXPECT_THROW(read_vec3(parsed.document, fits), Error);
}

TEST(GltfAccessor, RefusesViewsBeyondTheirBuffer) {
  GltfBuilder file;
  const int view = file.view(std::vector<float>{1, 2, 3, 4});
  file.doc["bufferViews"][static_cast<size_t>(view)]["byteLength"] = 17;
  EXPECT_NE(error_of([&] { Parsed parsed(file); }).find("goes beyond its buffer"), std::string::npos);
}

}  // namespace
}  // namespace relume
