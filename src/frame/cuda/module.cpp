#include "frame/cuda/module.h"

#include <algorithm>
#include <array>
#include <vector>

#include <fmt/format.h>

#include "core/activity.h"
#include "frame/kernel_names.h"
#include "relume/error.h"

namespace relume::cuda {
namespace {

constexpr const char* kArgumentName = "relume_kernel";

/// The names of all entries of a PTX module.
std::vector<std::string> entries_of(std::string_view ptx) {
  constexpr std::string_view kEntry = ".entry ";
  std::vector<std::string> names;
  for (size_t at = ptx.find(kEntry); at != std::string_view::npos; at = ptx.find(kEntry, at)) {
    at += kEntry.size();
    names.emplace_back(ptx.substr(at, ptx.find_first_of("( \t\n", at) - at));
  }
  return names;
}

/// The first line of the compiler's messages, without the end of the line.
std::string first_line(const std::string& messages) { return messages.substr(0, messages.find('\n')); }

}  // namespace

LoadedModule::LoadedModule(Queue& queue, const std::string& ptx) : queue_(queue) {
  const Queue::Current current(queue_);
  compile(ptx);
  try {
    find_kernels(ptx);
    queue_.check(queue_.driver().cuModuleGetGlobal(&argument_, &argument_bytes_, module_, kArgumentName),
                 fmt::format("finding the constant '{}'", kArgumentName));
  } catch (...) {
    queue_.driver().cuModuleUnload(module_);
    throw;
  }
}

LoadedModule::~LoadedModule() {
  queue_.free_objects([&] { queue_.driver().cuModuleUnload(module_); });
}

void LoadedModule::compile(const std::string& ptx) {
  const Activity activity(fmt::format("waiting for the driver to compile kernels for {}", queue_.device_name()));
  std::string messages(size_t{8} * 1024, '\0');
  std::array<CompilerOption, 2> names{CompilerOption::error_log_buffer, CompilerOption::error_log_buffer_size_bytes};
  // The driver takes numbers as addresses.
  std::array<void*, 2> values{messages.data(),
                              reinterpret_cast<void*>(messages.size() - 1)};  // NOLINT(performance-no-int-to-ptr)
  const Result result = queue_.driver().cuModuleLoadDataEx(&module_, ptx.c_str(), static_cast<unsigned>(names.size()),
                                                           names.data(), values.data());
  if (result == Result::success) return;
  messages.resize(std::char_traits<char>::length(messages.c_str()));
  const std::string reason = messages.empty() ? "" : fmt::format(" ('{}')", first_line(messages));
  queue_.check(result, fmt::format("compiling the kernels{}", reason));
}

void LoadedModule::find_kernels(std::string_view ptx) {
  for (const std::string& entry : entries_of(ptx)) {
    const std::optional<EntryKernel> named = kernel_of_entry(entry);
    if (!named) continue;
    Kernel kernel{nullptr, named->is_group};
    int stack_bytes = 0;
    const Driver& driver = queue_.driver();
    Result result = driver.cuModuleGetFunction(&kernel.function, module_, entry.c_str());
    if (result == Result::success)
      result = driver.cuFuncGetAttribute(&stack_bytes, FunctionAttribute::local_size_bytes, kernel.function);
    if (result != Result::success) queue_.check(result, fmt::format("loading the kernel {}", named->type));
    stack_bytes_ = std::max(stack_bytes_, static_cast<size_t>(stack_bytes));
    kernels_.emplace(named->type, kernel);
  }
}

const Kernel& LoadedModule::kernel(std::string_view type) const {
  const auto found = kernels_.find(type);
  if (found != kernels_.end()) return found->second;
  throw Error(ErrorCode::device,
              fmt::format("the device code has no kernel {}; add it to the kernels.inc of its folder", type));
}

}  // namespace relume::cuda
