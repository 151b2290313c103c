// The program's version, from CMake's project().
#pragma once

namespace relume::cli {

inline constexpr const char* kVersion = RELUME_VERSION;
inline constexpr const char* kVersionLine = "relume " RELUME_VERSION;

}  // namespace relume::cli
