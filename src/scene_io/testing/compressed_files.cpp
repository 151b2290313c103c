#include "scene_io/testing/compressed_files.h"

#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <meshoptimizer.h>

namespace relume::testing {

const std::vector<float> kPositions = {0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 1, 1, 0, 0};  // 4 vertices, stride 16
const std::vector<uint32_t> kIndices = {0, 1, 2, 2, 1, 3};

Bytes encode_vertices(const void* data, size_t count, size_t stride) {
  Bytes bytes(meshopt_encodeVertexBufferBound(count, stride));
  bytes.resize(
      meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(bytes.data()), bytes.size(), data, count, stride));
  return bytes;
}

Bytes encode_triangles(const std::vector<uint32_t>& indices) {
  Bytes bytes(meshopt_encodeIndexBufferBound(indices.size(), indices.size()));
  bytes.resize(meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(bytes.data()), bytes.size(), indices.data(),
                                         indices.size()));
  return bytes;
}

/// Compresses view `view`: it refers to the fallback buffer 1, its data to buffer 0.
int compress(GltfBuilder& file, const Bytes& data, size_t count, size_t stride, const char* mode, const char* filter) {
  const int view = file.add_view(data);
  json& v = file.doc["bufferViews"][static_cast<size_t>(view)];
  const json extension = {{"buffer", 0},
                          {"byteOffset", v["byteOffset"]},
                          {"byteLength", v["byteLength"]},
                          {"count", count},
                          {"mode", mode},
                          {"byteStride", stride},
                          {"filter", filter}};
  v = {{"buffer", 1}, {"byteLength", count * stride}, {"extensions", {{"EXT_meshopt_compression", extension}}}};
  if (std::string_view(mode) == "ATTRIBUTES") v["byteStride"] = stride;
  return view;
}

/// The builder's file with an empty second buffer.
std::string text_with_fallback(const GltfBuilder& file) {
  json doc = json::parse(file.text());
  doc["extensionsRequired"] = {"EXT_meshopt_compression"};
  doc["buffers"].push_back(
      {{"byteLength", 100000}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}});
  return doc.dump();
}

GltfBuilder meshopt_quad() {
  GltfBuilder file;
  const int positions = compress(file, encode_vertices(kPositions.data(), 4, 16), 4, 16, "ATTRIBUTES");
  const int indices = compress(file, encode_triangles(kIndices), 6, 4, "TRIANGLES");
  const json primitive = {{"attributes", {{"POSITION", file.add_accessor(positions, 4, 3, 5126)}}},
                          {"indices", file.add_accessor(indices, 6, 1, 5125)}};
  file.add("meshes", {{"primitives", {primitive}}});
  file.add_root({{"mesh", 0}});
  return file;
}

/// Two triangles with positions (id 0) and texture coordinates (id 1).
Bytes draco_quad(int method) {
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(2);
  const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const int uv = builder.AddAttribute(draco::GeometryAttribute::TEX_COORD, 2, draco::DT_UINT16);
  const float p[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  const uint16_t t[4][2] = {{0, 0}, {65535, 0}, {0, 65535}, {65535, 65535}};
  const int corners[2][3] = {{0, 1, 2}, {2, 1, 3}};
  for (int f = 0; f < 2; ++f) {
    const int* c = corners[f];
    builder.SetAttributeValuesForFace(position, draco::FaceIndex(static_cast<uint32_t>(f)), p[c[0]], p[c[1]], p[c[2]]);
    builder.SetAttributeValuesForFace(uv, draco::FaceIndex(static_cast<uint32_t>(f)), t[c[0]], t[c[1]], t[c[2]]);
  }
  const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
  draco::Encoder encoder;
  encoder.SetEncodingMethod(method);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 14);
  draco::EncoderBuffer buffer;
  if (!encoder.EncodeMeshToBuffer(*mesh, &buffer).ok()) throw Error("Draco's encoder failed");
  return to_bytes({buffer.data(), buffer.size()});
}

GltfBuilder draco_file(const Bytes& data) {
  GltfBuilder file;
  const int view = file.add_view(data);
  const int positions = file.add("accessors", {{"count", 4}, {"type", "VEC3"}, {"componentType", 5126}});
  const int uv = file.add("accessors", {{"count", 4}, {"type", "VEC2"}, {"componentType", 5123}, {"normalized", true}});
  const int indices = file.add("accessors", {{"count", 6}, {"type", "SCALAR"}, {"componentType", 5123}});
  const json extension = {{"bufferView", view}, {"attributes", {{"POSITION", 0}, {"TEXCOORD_0", 1}}}};
  file.add("meshes", {{"primitives",
                       {{{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", uv}}},
                         {"indices", indices},
                         {"extensions", {{"KHR_draco_mesh_compression", extension}}}}}}});
  file.add_root({{"mesh", 0}});
  return file;
}

}  // namespace relume::testing
