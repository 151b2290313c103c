// Description of the machine, for measurements.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace relume::cli {

/// Processor, rendering devices, version of relume, date: name and value. `devices`: values of the setting --device.
/// Throws Error for other values.
std::vector<std::pair<std::string, std::string>> machine_description(const std::vector<std::string>& devices);

}  // namespace relume::cli
