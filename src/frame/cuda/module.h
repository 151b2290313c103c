// Device code that the driver has compiled.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>

#include "frame/cuda/queue.h"

namespace relume::cuda {

/// A kernel of the device code.
struct Kernel {
  Function function = nullptr;
  bool is_group = false;
};

/// The kernels of a PTX module, by the names of their types, and the constant that holds the kernel of a launch.
class LoadedModule {
 public:
  /// Compiles the module; the driver keeps the result for later processes. The queue must outlive it. Throws Error with
  /// the messages of the driver's compiler.
  LoadedModule(Queue& queue, const std::string& ptx);
  ~LoadedModule();
  LoadedModule(const LoadedModule&) = delete;
  LoadedModule& operator=(const LoadedModule&) = delete;

  /// Throws Error if there is no kernel of that type (kernel_type_name()).
  const Kernel& kernel(std::string_view type) const;
  /// The constant that kernels read themselves from (frame/cuda/device_entry.h).
  DeviceAddress argument() const { return argument_; }
  size_t argument_bytes() const { return argument_bytes_; }
  /// Memory that each thread needs for its stack: the most of all kernels, bytes.
  size_t stack_bytes() const { return stack_bytes_; }

 private:
  struct Hash {
    using is_transparent = void;
    size_t operator()(std::string_view text) const { return std::hash<std::string_view>{}(text); }
  };

  void compile(const std::string& ptx);
  void find_kernels(std::string_view ptx);

  Queue& queue_;
  Module module_ = nullptr;
  std::unordered_map<std::string, Kernel, Hash, std::equal_to<>> kernels_;
  DeviceAddress argument_ = 0;
  size_t argument_bytes_ = 0;
  size_t stack_bytes_ = 0;
};

}  // namespace relume::cuda
