// Reference of the layers of --aov, as a section of a page.
#pragma once

#include <string>

namespace relume {

/// A table of every displayed buffer with its help and the slot choice that adds it, for docs/settings.md.
std::string aov_reference();

}  // namespace relume
