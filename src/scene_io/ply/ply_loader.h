// PLY files (Turk 1994, "The PLY Polygon File Format"): ASCII and binary of both byte orders.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

#include "scene/scene.h"

namespace relume {

/// One mesh from the elements "vertex" (x y z, nx ny nz, u v or s t, red green blue alpha) and "face" (vertex_indices
/// or vertex_index; polygons are fanned out). Missing normals are computed. Everything else in the file is skipped.
/// Throws Error. (assimp's importer does not bear damaged files.)
Scene load_ply(const std::filesystem::path& file);

/// As load_ply() for the bytes of a file, which `place` names in messages. Throws Error.
Scene load_ply_from_memory(std::span<const std::byte> file, const std::string& place);

}  // namespace relume
