#include "frame/kernel_names.h"

#include <cxxabi.h>

#include <cstdlib>
#include <memory>

namespace relume {

std::string demangled(const char* name) {
  int status = 0;
  const std::unique_ptr<char, decltype(&std::free)> text(abi::__cxa_demangle(name, nullptr, nullptr, &status),
                                                         &std::free);
  return text && status == 0 ? text.get() : "";
}

std::optional<EntryKernel> kernel_of_entry(const std::string& entry) {
  const std::string function = demangled(entry.c_str());
  for (const bool is_group : {false, true}) {
    const std::string_view prefix = is_group ? "void relume::device::run_group<" : "void relume::device::run<";
    const std::string_view suffix =
        is_group ? ">(unsigned int, unsigned int)" : ">(unsigned int, unsigned int, unsigned int, unsigned int)";
    if (!function.starts_with(prefix) || !function.ends_with(suffix)) continue;
    std::string type = function.substr(prefix.size(), function.size() - prefix.size() - suffix.size());
    if (type.ends_with(' ')) type.pop_back();  // between two closing brackets
    return EntryKernel{std::move(type), is_group};
  }
  return std::nullopt;
}

}  // namespace relume
