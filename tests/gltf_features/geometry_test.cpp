// Tests encodings of geometry against plain float accessors.
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <cmath>

#include "gltf_features/stage.h"
#include "scene_io/testing/compressed_files.h"

namespace relume::support {
namespace {

/// A square of 5 × 5 vertices with a central bump, in rows from the top.
struct Bump {
  static constexpr int kSide = 5;
  std::vector<float> positions;
  std::vector<float> normals;
  std::vector<float> uv;
  std::vector<uint16_t> triangles;

  Bump();
  size_t count() const { return positions.size() / 3; }
};

Bump::Bump() {
  for (int i = 0; i < kSide * kSide; ++i) {
    // Multiples of 1/16, which 16-bit integers and floats represent exactly.
    const float x = static_cast<float>(i % kSide) / 2 - 1;
    const float y = 1 - static_cast<float>(i / kSide) / 2;
    const float z = std::round(8 * (1 - x * x) * (1 - y * y)) / 16;
    positions.insert(positions.end(), {0.75f * x, 0.75f * y, z});
    const Vec3 n = glm::normalize(Vec3(x, y, 2));
    normals.insert(normals.end(), {n.x, n.y, n.z});
    uv.insert(uv.end(), {0.5f * (x + 1), 0.5f * (1 - y)});
  }
  for (int i = 0; i < kSide * (kSide - 1); ++i) {
    if (i % kSide == kSide - 1) continue;
    for (const int corner : {i, i + kSide, i + 1, i + 1, i + kSide, i + kSide + 1})
      triangles.push_back(static_cast<uint16_t>(corner));
  }
}

/// Adds a glossy, textured mesh with these attributes and indices in a root node with the members of `node`.
void show(Stage& stage, const json& attributes, const json& indices, const json& node = json::object(),
          const json& primitive_members = json::object()) {
  const json material = {{"pbrMetallicRoughness",
                          {{"baseColorTexture", stage.texture(4, 4, colorful(4, 4), {{"magFilter", 9729}})},
                           {"metallicFactor", 0.2},
                           {"roughnessFactor", 0.5}}}};
  json primitive = {
      {"attributes", attributes}, {"indices", indices}, {"material", stage.file.add("materials", material)}};
  primitive.update(primitive_members);
  json root = node;
  root["mesh"] = stage.file.add("meshes", {{"primitives", json::array({primitive})}});
  stage.file.add_root(root);
}

json plain_attributes(Stage& stage, const Bump& bump) {
  return {{"POSITION", stage.file.floats(bump.positions, 3)},
          {"NORMAL", stage.file.floats(bump.normals, 3)},
          {"TEXCOORD_0", stage.file.floats(bump.uv, 2)}};
}

int plain_indices(Stage& stage, const Bump& bump) { return stage.file.accessor(bump.triangles, 1, 5123); }

Scene lit(Stage& stage) {
  stage.sun();
  return stage.load();
}

/// Accessor of `components`-vectors as integers of T, padded to `padded` components.
template <typename T>
int quantised(Stage& stage, const std::vector<float>& values, int components, int padded, int component_type,
              double scale, bool normalized) {
  std::vector<T> integers;
  for (size_t i = 0; i < values.size(); ++i) {
    integers.push_back(static_cast<T>(std::lround(static_cast<double>(values[i]) * scale)));
    const bool last = static_cast<int>(i) % components == components - 1;
    if (last) integers.insert(integers.end(), static_cast<size_t>(padded - components), T{55});
  }
  const int view = stage.file.view(integers);
  stage.file.doc["bufferViews"][static_cast<size_t>(view)]["byteStride"] = static_cast<size_t>(padded) * sizeof(T);
  const size_t count = values.size() / static_cast<size_t>(components);
  return stage.file.add_accessor(view, count, components, component_type, normalized);
}

/// KHR_mesh_quantization: normalised 16-bit positions and texture coordinates, normalised 8-bit normals.
Scene normalised_integers(Way way) {
  Stage stage;
  const Bump bump;
  json attributes = plain_attributes(stage, bump);
  if (way == Way::feature) {
    attributes = {{"POSITION", quantised<int16_t>(stage, bump.positions, 3, 4, 5122, 32767, true)},
                  {"NORMAL", quantised<int8_t>(stage, bump.normals, 3, 4, 5120, 127, true)},
                  {"TEXCOORD_0", quantised<uint16_t>(stage, bump.uv, 2, 2, 5123, 65535, true)}};
  }
  if (way != Way::ignored) show(stage, attributes, plain_indices(stage, bump));
  return lit(stage);
}

/// Same with unnormalised integers: the node scales positions back, KHR_texture_transform the coordinates.
Scene whole_integers(Way way) {
  Stage stage;
  const Bump bump;
  json attributes = plain_attributes(stage, bump);
  json node = json::object();
  if (way != Way::plain) {
    attributes["POSITION"] = quantised<int8_t>(stage, bump.positions, 3, 4, 5120, 16, false);
    attributes["TEXCOORD_0"] = quantised<uint16_t>(stage, bump.uv, 2, 2, 5123, 1000, false);
    node = {{"scale", {0.0625, 0.0625, 0.0625}}};
  }
  show(stage, attributes, plain_indices(stage, bump), node);
  if (way == Way::feature) {
    json& texture = stage.file.doc["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"];
    texture["extensions"]["KHR_texture_transform"]["scale"] = {0.001, 0.001};
  }
  return lit(stage);
}

/// Sparse positions that replace some of a view's, or zeros without a view.
Scene sparse(Way way, bool with_view) {
  Stage stage;
  const Bump bump;
  json attributes = plain_attributes(stage, bump);
  if (way != Way::plain) {
    std::vector<float> base = with_view ? bump.positions : std::vector<float>();
    std::vector<uint16_t> places;
    std::vector<float> values;
    for (size_t i = 0; i < bump.count(); i += with_view ? 3 : 1) {
      places.push_back(static_cast<uint16_t>(i));
      for (size_t c = 3 * i; c < 3 * i + 3; ++c) {
        values.push_back(bump.positions[c]);
        if (with_view) base[c] = -0.5f * bump.positions[c];
      }
    }
    const int dense = with_view ? stage.file.floats(base, 3) : -1;
    json accessor = {{"count", bump.count()}, {"type", "VEC3"}, {"componentType", 5126}};
    if (with_view) accessor = stage.file.doc["accessors"][static_cast<size_t>(dense)];
    if (way == Way::feature) {
      accessor["sparse"] = {{"count", places.size()},
                            {"indices", {{"bufferView", stage.file.view(places)}, {"componentType", 5123}}},
                            {"values", {{"bufferView", stage.file.view(values)}}}};
    }
    if (way == Way::feature || with_view) attributes["POSITION"] = stage.file.add("accessors", accessor);
  }
  if (way == Way::ignored && !with_view) return lit(stage);  // zeros give no triangles
  show(stage, attributes, plain_indices(stage, bump));
  return lit(stage);
}

/// EXT_meshopt_compression of all attributes and indices, with the octahedral filter for normals.
Scene meshopt(Way way) {
  Stage stage;
  const Bump bump;
  if (way == Way::ignored) return lit(stage);
  if (way == Way::plain) {
    show(stage, plain_attributes(stage, bump), plain_indices(stage, bump));
    return lit(stage);
  }
  const size_t n = bump.count();
  std::vector<float> wide;  // the filter requires four floats per normal
  for (size_t i = 0; i < n; ++i)
    wide.insert(wide.end(), {bump.normals[3 * i], bump.normals[3 * i + 1], bump.normals[3 * i + 2], 0});
  std::vector<int16_t> octahedral(4 * n);
  meshopt_encodeFilterOct(octahedral.data(), n, 8, 16, wide.data());
  const auto attribute = [&](const Bytes& data, size_t stride, const char* filter) {
    return testing::compress(stage.file, data, n, stride, "ATTRIBUTES", filter);
  };
  const int positions = attribute(testing::encode_vertices(bump.positions.data(), n, 12), 12, "NONE");
  const int normals = attribute(testing::encode_vertices(octahedral.data(), n, 8), 8, "OCTAHEDRAL");
  const int uv = attribute(testing::encode_vertices(bump.uv.data(), n, 8), 8, "NONE");
  const Bytes triangles = testing::encode_triangles({bump.triangles.begin(), bump.triangles.end()});
  const int indices = testing::compress(stage.file, triangles, bump.triangles.size(), 2, "TRIANGLES");
  show(stage,
       {{"POSITION", stage.file.add_accessor(positions, n, 3, 5126)},
        {"NORMAL", stage.file.add_accessor(normals, n, 3, 5122, true)},
        {"TEXCOORD_0", stage.file.add_accessor(uv, n, 2, 5126)}},
       stage.file.add_accessor(indices, bump.triangles.size(), 1, 5123));
  stage.sun();
  name_extensions(stage.file.doc);
  return testing::load_text(testing::text_with_fallback(stage.file));
}

/// The bump as unquantised Draco data with the attributes position, normal, texture coordinates.
Bytes draco_data(const Bump& bump, int method) {
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(static_cast<int>(bump.triangles.size() / 3));
  const auto add = [&](draco::GeometryAttribute::Type type, const std::vector<float>& values, int8_t components) {
    const int id = builder.AddAttribute(type, components, draco::DT_FLOAT32);
    for (size_t f = 0; f < bump.triangles.size() / 3; ++f) {
      const auto at = [&](size_t k) { return &values[bump.triangles[3 * f + k] * static_cast<size_t>(components)]; };
      builder.SetAttributeValuesForFace(id, draco::FaceIndex(static_cast<uint32_t>(f)), at(0), at(1), at(2));
    }
  };
  add(draco::GeometryAttribute::POSITION, bump.positions, 3);
  add(draco::GeometryAttribute::NORMAL, bump.normals, 3);
  add(draco::GeometryAttribute::TEX_COORD, bump.uv, 2);
  const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
  draco::Encoder encoder;
  encoder.SetEncodingMethod(method);
  draco::EncoderBuffer buffer;
  if (!encoder.EncodeMeshToBuffer(*mesh, &buffer).ok()) throw Error("Draco's encoder failed");
  return testing::to_bytes({buffer.data(), buffer.size()});
}

Scene draco_compressed(Way way, int method) {
  Stage stage;
  const Bump bump;
  if (way == Way::plain) show(stage, plain_attributes(stage, bump), plain_indices(stage, bump));
  if (way == Way::feature) {
    const int view = stage.file.add_view(draco_data(bump, method));
    const auto accessor = [&](const char* type, size_t count, int component_type) {
      return stage.file.add("accessors", {{"count", count}, {"type", type}, {"componentType", component_type}});
    };
    const size_t n = bump.count();
    const json extension = {{"bufferView", view}, {"attributes", {{"POSITION", 0}, {"NORMAL", 1}, {"TEXCOORD_0", 2}}}};
    const json attributes = {{"POSITION", accessor("VEC3", n, 5126)},
                             {"NORMAL", accessor("VEC3", n, 5126)},
                             {"TEXCOORD_0", accessor("VEC2", n, 5126)}};
    show(stage, attributes, accessor("SCALAR", bump.triangles.size(), 5123), json::object(),
         {{"extensions", {{"KHR_draco_mesh_compression", extension}}}});
  }
  return lit(stage);
}

const FeatureCase kCases[] = {
    // 8-bit normals deviate by up to half a degree.
    {"QuantisedNormalised", normalised_integers, 0.05},
    {"QuantisedIntegers", whole_integers, 1e-4},
    {"SparseOverAView", [](Way way) { return sparse(way, true); }},
    {"SparseOverZeros", [](Way way) { return sparse(way, false); }},
    {"Meshopt", meshopt, 1e-3},  // 16-bit normals
    {"DracoSequential", [](Way way) { return draco_compressed(way, draco::MESH_SEQUENTIAL_ENCODING); }, 1e-4},
    {"DracoEdgebreaker", [](Way way) { return draco_compressed(way, draco::MESH_EDGEBREAKER_ENCODING); }, 1e-4},
};

class GeometryFeature : public FeatureTest {};
TEST_P(GeometryFeature, MatchesPlainScene) { check(); }
INSTANTIATE_TEST_SUITE_P(Gltf, GeometryFeature, ::testing::ValuesIn(kCases), feature_name);

}  // namespace
}  // namespace relume::support
