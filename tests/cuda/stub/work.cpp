// Entry points of the stub driver: memory, modules, launches, streams and events.
#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <string>
#include <utility>

#include "stub/guarded.h"
#include "stub/modules.h"

namespace stub {
namespace {

constexpr unsigned kAttachGlobal = 1;
constexpr unsigned kBlockingSync = 1;
constexpr int kHost = -1;
constexpr int kErrorLog = 5;
constexpr int kErrorLogBytes = 6;
constexpr uint32_t kMaxGridHeight = 65535;

void* pointer(unsigned long long address) {
  return reinterpret_cast<void*>(address);  // NOLINT(performance-no-int-to-ptr)
}
unsigned long long address_of(const void* block) { return reinterpret_cast<uintptr_t>(block); }

bool is_locked(const State& state, const void* address, size_t bytes) {
  const auto* const begin = static_cast<const char*>(address);
  return std::any_of(state.locked.begin(), state.locked.end(), [&](const auto& block) {
    const auto* const first = static_cast<const char*>(block.first);
    return begin >= first && begin + bytes <= first + block.second;
  });
}

/// Executes a copy. Its source must not be freed before.
void copy_locked(State& state, unsigned long long to, const void* from, size_t bytes) {
  if (state.sticky != kSuccess) return;
  if (is_locked(state, from, bytes)) {
    std::memcpy(pointer(to), from, bytes);
  } else {
    state.sticky = kIllegalAddress;
  }
}

/// Whether the bytes are in a variable of a loaded module.
bool is_variable(const State& state, const void* address, size_t bytes) {
  const auto* const begin = static_cast<const unsigned char*>(address);
  for (const Module* module : state.modules) {
    for (const auto& [symbol, value] : module->variables) {
      if (begin >= value.data() && begin + bytes <= value.data() + value.size()) return true;
    }
  }
  return false;
}

/// Writes the compiler's messages to the caller's buffer, if there is one.
void write_log(const std::string& message, unsigned options, const int* names, void** values) {
  char* buffer = nullptr;
  size_t bytes = 0;
  for (unsigned i = 0; i < options; ++i) {
    if (names[i] == kErrorLog) buffer = static_cast<char*>(values[i]);
    if (names[i] == kErrorLogBytes) bytes = reinterpret_cast<size_t>(values[i]);
  }
  if (buffer && bytes > 0) std::strncpy(buffer, message.c_str(), bytes - 1);
}

/// Copies of the parameters of a launch. The first word holds every type of relume's parameters.
std::vector<std::vector<uint64_t>> copy_parameters(const ptx::Entry& entry, void** parameters) {
  std::vector<std::vector<uint64_t>> copies;
  for (size_t i = 0; i < entry.parameter_bytes.size(); ++i) {
    copies.emplace_back((entry.parameter_bytes[i] + 7) / 8);
    std::memcpy(copies.back().data(), parameters[i], entry.parameter_bytes[i]);
  }
  return copies;
}

bool is_loaded(const State& state, const Function* function) {
  return std::any_of(state.modules.begin(), state.modules.end(), [&](const Module* module) {
    return std::any_of(module->functions.begin(), module->functions.end(),
                       [&](const auto& known) { return &known.second == function; });
  });
}

}  // namespace

extern "C" {

int cuMemGetInfo_v2(size_t* free, size_t* total) {
  return with_context("cuMemGetInfo_v2", [&](State& state) {
    *total = state.settings.memory_mib << 20;
    *free = *total - std::min(*total, state.managed.bytes());
    return kSuccess;
  });
}

int cuMemAllocManaged(unsigned long long* address, size_t bytes, unsigned flags) {
  return outside_of_captures("cuMemAllocManaged", [&](State& state) {
    if (bytes == 0 || flags != kAttachGlobal) return kInvalidValue;
    void* const block = state.managed.allocate(bytes);
    *address = address_of(block);
    return block ? kSuccess : kOutOfMemory;
  });
}

int cuMemAlloc_v2(unsigned long long* address, size_t bytes) {
  return outside_of_captures("cuMemAlloc_v2", [&](State& state) {
    if (bytes == 0) return kInvalidValue;
    void* const block = state.managed.allocate(bytes);
    *address = address_of(block);
    return block ? kSuccess : kOutOfMemory;
  });
}

int cuMemFree_v2(unsigned long long address) {
  return outside_of_captures("cuMemFree_v2", [&](State& state) {
    state.drain_all();
    return state.managed.free(pointer(address)) ? kSuccess : kInvalidValue;
  });
}

int cuMemHostAlloc(void** address, size_t bytes, unsigned) {
  return outside_of_captures("cuMemHostAlloc", [&](State& state) {
    *address = std::malloc(bytes);
    if (!*address) return kOutOfMemory;
    state.locked.emplace(*address, bytes);
    return kSuccess;
  });
}

int cuMemFreeHost(void* address) {
  return outside_of_captures("cuMemFreeHost", [&](State& state) {
    state.drain_all();
    if (state.locked.erase(address) == 0) return kInvalidValue;
    std::free(address);
    return kSuccess;
  });
}

int cuMemPrefetchAsync(unsigned long long address, size_t bytes, int device, Stream* stream) {
  return with_idle_stream("cuMemPrefetchAsync", stream, [&](State& state) {
    if (!state.settings.concurrent) return kInvalidDevice;
    if (device != kHost && (device < 0 || device >= state.settings.devices)) return kInvalidDevice;
    if (bytes == 0 || !state.managed.contains(pointer(address), bytes)) return kInvalidValue;
    if (device != kHost) ++state.moved_to[device];
    state.add(*stream, [&state, address, bytes] {
      state.clock_s += 1e-10 * static_cast<double>(bytes);
      // A block must not be freed before its move.
      if (state.sticky == kSuccess && !state.managed.contains(pointer(address), bytes)) state.sticky = kIllegalAddress;
    });
    return kSuccess;
  });
}

int cuMemcpyHtoDAsync_v2(unsigned long long to, const void* from, size_t bytes, Stream* stream) {
  return with_context("cuMemcpyHtoDAsync_v2", [&](State& state) {
    if (!state.streams.contains(stream)) return kInvalidHandle;
    // Other memory is copied before the driver's function returns, if at all.
    if (!is_locked(state, from, bytes) || !is_variable(state, pointer(to), bytes)) return kInvalidValue;
    return state.add_node(*stream, {GraphNode::Kind::copy, [&state, to, from, bytes](Stream& into) {
                                      state.add(into,
                                                [&state, to, from, bytes] { copy_locked(state, to, from, bytes); });
                                    }});
  });
}

int cuMemcpyDtoDAsync_v2(unsigned long long to, unsigned long long from, size_t bytes, Stream* stream) {
  return with_idle_stream("cuMemcpyDtoDAsync_v2", stream, [&](State& state) {
    if (!state.managed.contains(pointer(to), bytes) || !state.managed.contains(pointer(from), bytes))
      return kInvalidValue;
    state.add_work(*stream, [=] { std::memcpy(pointer(to), pointer(from), bytes); });
    return kSuccess;
  });
}

int cuMemcpyDtoHAsync_v2(void* to, unsigned long long from, size_t bytes, Stream* stream) {
  return with_idle_stream("cuMemcpyDtoHAsync_v2", stream, [&](State& state) {
    if (bytes == 0 || !state.managed.contains(pointer(from), bytes)) return kInvalidValue;
    state.add_copy(*stream, [=] { std::memcpy(to, pointer(from), bytes); });
    // The driver waits for copies to other memory.
    while (!is_locked(state, to, bytes) && state.execute_one(*stream)) {
    }
    return state.sticky;
  });
}

int cuMemsetD8Async(unsigned long long to, unsigned char value, size_t bytes, Stream* stream) {
  return with_idle_stream("cuMemsetD8Async", stream, [&](State& state) {
    if (!state.managed.contains(pointer(to), bytes)) return kInvalidValue;
    state.add_work(*stream, [=] { std::memset(pointer(to), value, bytes); });
    return kSuccess;
  });
}

int cuModuleLoadDataEx(Module** handle, const void* image, unsigned options, const int* names, void** values) {
  return outside_of_captures("cuModuleLoadDataEx", [&](State& state) {
    std::string message;
    const ptx::Module* const translated = find_module(static_cast<const char*>(image), message);
    if (!translated) {
      write_log(message, options, names, values);
      return kInvalidPtx;
    }
    create(state.modules, handle);
    (*handle)->translated = translated;
    return kSuccess;
  });
}

int cuModuleUnload(Module* module) {
  return with_context("cuModuleUnload", [&](State& state) { return destroy(state.modules, module); });
}

int cuModuleGetFunction(const Function** function, Module* module, const char* name) {
  return with_context("cuModuleGetFunction", [&](State& state) {
    if (!state.modules.contains(module)) return kInvalidHandle;
    for (const ptx::Entry& entry : module->translated->entries) {
      if (entry.name != name) continue;
      *function = &module->functions.try_emplace(&entry, Function{module, &entry}).first->second;
      return kSuccess;
    }
    return kNotFound;
  });
}

int cuModuleGetGlobal_v2(unsigned long long* address, size_t* bytes, Module* module, const char* name) {
  return with_context("cuModuleGetGlobal_v2", [&](State& state) {
    if (!state.modules.contains(module)) return kInvalidHandle;
    for (const ptx::Symbol& symbol : module->translated->symbols) {
      if (symbol.name != name) continue;
      const auto* const value = static_cast<const unsigned char*>(symbol.address);
      auto& variable = module->variables[&symbol];
      if (variable.empty()) variable.assign(value, value + symbol.bytes);
      *address = address_of(variable.data());
      *bytes = variable.size();
      return kSuccess;
    }
    return kNotFound;
  });
}

int cuFuncGetAttribute(int* value, int attribute, const Function*) {
  return with_context("cuFuncGetAttribute", [&](State& state) {
    constexpr int kStackBytes = 3;
    if (attribute != kStackBytes) return kInvalidValue;
    *value = state.settings.stack;
    return kSuccess;
  });
}

int cuLaunchKernel(const Function* function, unsigned grid_x, unsigned grid_y, unsigned grid_z, unsigned block_x,
                   unsigned block_y, unsigned block_z, unsigned shared_bytes, Stream* stream, void** parameters,
                   void** extra) {
  return with_context("cuLaunchKernel", [&](State& state) {
    if (!is_loaded(state, function) || !state.streams.contains(stream)) return kInvalidHandle;
    const uint64_t threads = uint64_t{block_x} * block_y * block_z;
    if (grid_x == 0 || grid_y == 0 || grid_z == 0 || grid_y > kMaxGridHeight || threads == 0 || threads > 1024 || extra)
      return kInvalidValue;
    const KernelCall call{function,
                          {grid_x, grid_y, grid_z},
                          {block_x, block_y, block_z},
                          shared_bytes,
                          copy_parameters(*function->entry, parameters)};
    return state.add_node(*stream,
                          {GraphNode::Kind::kernel, [&state, call](Stream& into) { state.add_kernel(into, call); }});
  });
}

int cuStreamCreate(Stream** stream, unsigned) {
  return with_context("cuStreamCreate", [&](State& state) { return create(state.streams, stream); });
}

int cuStreamDestroy_v2(Stream* stream) {
  return with_context("cuStreamDestroy_v2", [&](State& state) { return destroy(state.streams, stream); });
}

int cuStreamSynchronize(Stream* stream) {
  return with_idle_stream("cuStreamSynchronize", stream, [&](State& state) {
    state.drain(*stream);
    return state.sticky;
  });
}

int cuStreamWaitEvent(Stream* stream, Event* event, unsigned flags) {
  return with_idle_stream("cuStreamWaitEvent", stream, [&](State& state) {
    if (!state.events.contains(event)) return kInvalidHandle;
    if (flags != 0) return kInvalidValue;
    state.add(*stream, [&state, stream, event, record = event->records] { state.wait_for(*stream, event, record); });
    return kSuccess;
  });
}

int cuEventCreate(Event** event, unsigned flags) {
  return with_context(
      "cuEventCreate",
      // Others occupy a core while the host waits.
      [&](State& state) { return flags == kBlockingSync ? create(state.events, event) : kInvalidValue; });
}

int cuEventDestroy_v2(Event* event) {
  return with_context("cuEventDestroy_v2", [&](State& state) { return destroy(state.events, event); });
}

int cuEventRecord(Event* event, Stream* stream) {
  // In a capture, it would record nothing: the event could be neither asked for nor timed.
  return with_idle_stream("cuEventRecord", stream, [&](State& state) {
    if (!state.events.contains(event)) return kInvalidHandle;
    state.record(*stream, event);
    return kSuccess;
  });
}

int cuEventQuery(Event* event) {
  return with_context("cuEventQuery", [&](State& state) {
    if (!state.events.contains(event)) return kInvalidHandle;
    // The device proceeds while the host asks.
    for (Stream* stream : state.streams) state.execute_one(*stream);
    if (state.sticky != kSuccess) return state.sticky;
    return event->done || event->records == 0 ? kSuccess : kNotReady;
  });
}

int cuEventSynchronize(Event* event) {
  return with_context("cuEventSynchronize", [&](State& state) {
    if (!state.events.contains(event)) return kInvalidHandle;
    for (Stream* stream : state.streams) {
      while (event->records > 0 && !event->done && state.sticky == kSuccess && state.execute_one(*stream)) {
      }
    }
    if (event->done) state.open_memory();
    return state.sticky;
  });
}

int cuEventElapsedTime(float* milliseconds, Event* begin, Event* end) {
  return with_context("cuEventElapsedTime", [&](State& state) {
    if (!state.events.contains(begin) || !state.events.contains(end)) return kInvalidHandle;
    if (begin->records == 0 || end->records == 0) return kInvalidHandle;
    if (!begin->done || !end->done) return kNotReady;
    *milliseconds = static_cast<float>(1e3 * (end->time_s - begin->time_s));
    return kSuccess;
  });
}

}  // extern "C"
}  // namespace stub
