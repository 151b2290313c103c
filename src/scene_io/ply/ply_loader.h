// Loads PLY files (Turk 1994, "The PLY Polygon File Format"): ASCII and binary of both byte orders.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

#include "scene/scene.h"
#include "scene_io/warnings.h"

namespace relume {

/// Loads one mesh from the elements "vertex" (x y z, nx ny nz, u v or s t, red green blue alpha) and "face"
/// (vertex_indices or vertex_index; polygons become fans). Missing normals are computed; other elements are skipped.
/// Throws Error. assimp's importer is not used because it does not handle damaged files.
Scene load_ply(const std::filesystem::path& file);

/// Loads the bytes of a file, as load_ply() does; `place` names it in messages. Throws Error.
Scene load_ply_from_memory(std::span<const std::byte> file, const std::string& place);

/// Mesh of the file as it is stored, before repair_mesh(). Throws Error.
Mesh read_ply_mesh(std::span<const std::byte> file, const std::string& place, Warnings& warnings);

}  // namespace relume
