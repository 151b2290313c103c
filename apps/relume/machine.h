// Description of the machine, for measurements.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace relume::cli {

/// Processor, version of relume, date: name and value.
std::vector<std::pair<std::string, std::string>> machine_description();

}  // namespace relume::cli
