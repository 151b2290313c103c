// Makes compressed glTF files for tests with the encoders of meshoptimizer and Draco.
#pragma once

#include "scene_io/testing/scene_files.h"

namespace relume::testing {

Bytes encode_vertices(const void* data, size_t count, size_t stride);
Bytes encode_triangles(const std::vector<uint32_t>& indices);
/// Adds a view with EXT_meshopt_compression: data in buffer 0, fallback in buffer 1.
int compress(GltfBuilder& file, const Bytes& data, size_t count, size_t stride, const char* mode,
             const char* filter = "NONE");
/// The builder's file with an empty second buffer.
std::string text_with_fallback(const GltfBuilder& file);
/// Compressed quad with corners (0,0,0) (1,0,0) (0,1,0) (1,1,0), for text_with_fallback().
GltfBuilder meshopt_quad();

/// The same quad in Draco's encoding `method`: positions (id 0) and texture coordinates (id 1).
Bytes draco_quad(int method);
/// A file with this Draco data.
GltfBuilder draco_file(const Bytes& data);

}  // namespace relume::testing
