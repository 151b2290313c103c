// The setting --device.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "frame/device.h"

namespace relume::cuda {

/// The processor that a value of the setting names.
struct DeviceChoice {
  enum class Kind {
    host,       ///< "cpu"
    automatic,  ///< "auto": a GPU that can be used, or else the host
    gpu,        ///< "cuda" or "cuda:N"
  };
  Kind kind = Kind::host;
  int index = 0;  ///< N: of the GPU among those of the driver
};

/// Throws Error for other values.
DeviceChoice parse_device(std::string_view value);

/// Opens the GPU that the value names, with the device code of the library. nullptr: the host. The environment variable
/// RELUME_CUDA_GRAPHS turns off graphs of launches ("0"). Throws Error for other values, and if a GPU is named that
/// cannot be used.
std::unique_ptr<Device> open_chosen_device(std::string_view value);

/// The value, with "auto" replaced by what it opens now: "cuda:N" or "cpu". Opens and closes that GPU. Throws Error for
/// other values.
std::string resolved_device(std::string_view value);

}  // namespace relume::cuda
