#include "machine.h"

#include <chrono>
#include <thread>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "platform.h"
#include "version.h"

namespace relume::cli {

std::vector<std::pair<std::string, std::string>> machine_description() {
  const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  return {{"Processor", fmt::format("{}, {} hardware threads", processor_name(), std::thread::hardware_concurrency())},
          {"Program", kVersionLine},
          {"Date", fmt::format("{:%Y-%m-%d %H:%M} UTC", fmt::gmtime(std::chrono::system_clock::to_time_t(now)))}};
}

}  // namespace relume::cli
