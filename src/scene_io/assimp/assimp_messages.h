// Translates assimp's messages into plain sentences.
#pragma once

#include <string>
#include <string_view>

namespace relume {

inline constexpr std::string_view kNoTriangles = "the file has no triangles; check that it is the right one";

/// Problem and remedy: "line 5: a number is expected (near 'x'); export it again …". Unknown messages give "the file's
/// content is damaged or not supported; …".
std::string explain_assimp_problem(std::string_view message);

}  // namespace relume
