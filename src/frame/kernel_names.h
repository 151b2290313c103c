// Names of kernels that host and device code agree on: the C++ types of the kernels, in words. Mangled names of types
// and of entries abbreviate repeated parts differently.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <typeinfo>

namespace relume {

/// A mangled name of a type or function in words. Empty if it is not one.
std::string demangled(const char* name);

/// Name of a kernel's type, such as "relume::FillElementsKernel<float>".
template <typename Kernel>
const std::string& kernel_type_name() {
  static const std::string name = demangled(typeid(Kernel).name());
  return name;
}

/// The kernel that an entry of device code calls.
struct EntryKernel {
  std::string type;       ///< its kernel_type_name()
  bool is_group = false;  ///< whether it is a group kernel
};

/// Returns the kernel of an entry with the given mangled name (frame/cuda/device_entry.h); nothing for other functions.
std::optional<EntryKernel> kernel_of_entry(const std::string& entry);

}  // namespace relume
