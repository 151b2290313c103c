// Version of relume.
#pragma once

#include "relume/export.h"

#define RELUME_VERSION_MAJOR 0
#define RELUME_VERSION_MINOR 1
#define RELUME_VERSION_PATCH 0

namespace relume {

/// Version of the library at run time, such as "0.1.0". It may be newer than the headers.
RELUME_API const char* version();

}  // namespace relume
