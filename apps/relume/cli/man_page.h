// Manual pages with the macros of man(7), from the commands' declarations.
#pragma once

#include <string>
#include <vector>

#include "cli/command.h"

namespace relume::cli {

/// "relume-render".
std::string man_page_name(const Command& command);

/// relume-COMMAND(1).
std::string man_page(const Command& command, const std::vector<Command>& commands);

/// relume(1).
std::string man_overview(const std::vector<Command>& commands);

}  // namespace relume::cli
