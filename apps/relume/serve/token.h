// The secret that a viewer shows first.
#pragma once

#include <string>
#include <string_view>

namespace relume::serve {

/// 256 random bits of the system, as 64 hexadecimal digits. Throws Error if the system provides none.
std::string make_token();

/// Compares two texts. The time depends on the length of `given` only.
bool equal_in_constant_time(std::string_view secret, std::string_view given);

}  // namespace relume::serve
