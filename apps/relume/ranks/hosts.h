// The machines of ranks, and whether all ranks render the same.
#pragma once

#include <string>
#include <vector>

#include "ranks/message.h"

namespace relume::ranks {

/// The first message of a rank. `identity`: of program, scene and settings.
Bytes hello_message(const std::string& identity);

class HostList {
 public:
  HostList(int ranks, std::string identity) : identity_(std::move(identity)), hosts_(static_cast<size_t>(ranks)) {}

  /// Notes a hello. Returns the reason why the rank cannot take part; empty if it can.
  std::string add(const Message& hello);
  /// "rank 1 on node7"
  std::string name_of(int rank) const;

 private:
  std::string identity_;
  std::vector<std::string> hosts_;
};

}  // namespace relume::ranks
