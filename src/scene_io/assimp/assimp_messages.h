// Plain sentences for assimp's messages.
#pragma once

#include <string>
#include <string_view>

namespace relume {

inline constexpr std::string_view kNoTriangles = "the file has no triangles; check that it is the right one";

/// The problem of a file and a remedy: "line 5: a number is expected (near 'x'); export it again …". For an unknown
/// message: "the file's content is damaged or not supported; …".
std::string explain_assimp_problem(std::string_view message);

}  // namespace relume
