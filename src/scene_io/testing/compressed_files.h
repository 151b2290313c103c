// Compressed glTF files for tests, made with the encoders of meshoptimizer and Draco.
#pragma once

#include "scene_io/testing/scene_files.h"

namespace relume::testing {

Bytes encode_vertices(const void* data, size_t count, size_t stride);
Bytes encode_triangles(const std::vector<uint32_t>& indices);
/// Adds a view with EXT_meshopt_compression whose data are in buffer 0 and whose fallback is buffer 1.
int compress(GltfBuilder& file, const Bytes& data, size_t count, size_t stride, const char* mode,
             const char* filter = "NONE");
/// The builder's file with a second buffer that has no bytes.
std::string text_with_fallback(const GltfBuilder& file);
/// Corners (0,0,0) (1,0,0) (0,1,0) (1,1,0) and two triangles, compressed; for text_with_fallback().
GltfBuilder meshopt_quad();

/// The same quad as Draco data: positions (id 0) and texture coordinates (id 1), with Draco's encoding method.
Bytes draco_quad(int method);
/// A file with these Draco data.
GltfBuilder draco_file(const Bytes& data);

}  // namespace relume::testing
