// Which version of relume this is.
#pragma once

#include "relume/export.h"

#define RELUME_VERSION_MAJOR 0
#define RELUME_VERSION_MINOR 1
#define RELUME_VERSION_PATCH 0

namespace relume {

/// "0.1.0": of the library that runs, which may be newer than the headers.
RELUME_API const char* version();

}  // namespace relume
