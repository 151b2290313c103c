#include "relume/version.h"

namespace relume {

const char* version() { return RELUME_VERSION; }

}  // namespace relume
