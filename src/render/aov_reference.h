// The layers that --aov knows, as a page's section.
#pragma once

#include <string>

namespace relume {

/// A table of every buffer that is shown, with what it shows and the choice of a slot that brings it along; of
/// docs/settings.md.
std::string aov_reference();

}  // namespace relume
