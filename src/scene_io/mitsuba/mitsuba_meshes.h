// Meshes of Mitsuba's shapes in object space, without material. Texture coordinates are Mitsuba's: v = 0 is the top row
// of an image.
#pragma once

#include <span>
#include <string>

#include "scene/scene.h"

namespace relume::mitsuba {

/// Mesh of an OBJ file: polygons as triangle fans, without its groups and materials. `flips_v`: v becomes 1 - v.
/// Normals are those of the file if all corners have one. Throws Error with `place`.
Mesh read_obj(std::span<const std::byte> file, bool flips_v, const std::string& place);

/// Bytes to which all meshes of a "serialized" file of this size may decompress together. Real meshes compress to more
/// than a thirtieth.
constexpr uint64_t largest_inflated(uint64_t file_bytes) { return (uint64_t{1} << 24) + 32 * file_bytes; }

/// Mesh number `index` of a file in Mitsuba's "serialized" format, versions 3 to 5. Takes its decompressed size from
/// `inflatable`. Throws Error with `place`, also if that is not enough.
Mesh read_serialized(std::span<const std::byte> file, int64_t index, const std::string& place, uint64_t& inflatable);

/// Mesh of "rectangle", "cube", "sphere", "disk" or "cylinder" of unit size: Mitsuba's shape before its parameters and
/// transform. Empty for other types. `segments`: of a full turn.
Mesh unit_shape(const std::string& type, int segments);

/// Swaps front and back, and negates normals.
void flip(Mesh& mesh);

/// Smooth normals that faces of equal positions share; for meshes whose vertices are split at texture seams.
void add_smooth_normals(Mesh& mesh);

/// Sets tangents along growing u. Its frames are those of Mitsuba: the normal map's Y axis is n × ∂p/∂u, which is that
/// of glTF where v runs downwards. No effect without texture coordinates and normals.
void add_tangents(Mesh& mesh);

/// Lengths of ∂p/∂u and ∂p/∂v after a transform, averaged over the area; the second is negative where v grows along
/// (∂p/∂u) × n. 1 for meshes without texture coordinates.
Vec2 stretch(const Mesh& mesh, const Mat4& to_world);

}  // namespace relume::mitsuba
