// Entry points of the stub driver: the driver itself, devices, contexts, and the control of tests.
#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <string>

#include "stub/control.h"
#include "stub/guarded.h"

namespace stub {
namespace {

struct ErrorText {
  int result;
  const char* name;
  const char* text;
};

constexpr ErrorText kErrors[] = {
    {0, "CUDA_SUCCESS", "no error"},
    {1, "CUDA_ERROR_INVALID_VALUE", "invalid argument"},
    {2, "CUDA_ERROR_OUT_OF_MEMORY", "out of memory"},
    {3, "CUDA_ERROR_NOT_INITIALIZED", "initialization error"},
    {46, "CUDA_ERROR_DEVICE_UNAVAILABLE", "CUDA-capable device(s) is/are busy or unavailable"},
    {100, "CUDA_ERROR_NO_DEVICE", "no CUDA-capable device is detected"},
    {101, "CUDA_ERROR_INVALID_DEVICE", "invalid device ordinal"},
    {201, "CUDA_ERROR_INVALID_CONTEXT", "invalid device context"},
    {208, "CUDA_ERROR_ALREADY_MAPPED", "resource already mapped"},
    {211, "CUDA_ERROR_NOT_MAPPED", "resource not mapped"},
    {218, "CUDA_ERROR_INVALID_PTX", "a PTX JIT compilation failed"},
    {219, "CUDA_ERROR_INVALID_GRAPHICS_CONTEXT", "invalid OpenGL or DirectX context"},
    {226, "CUDA_ERROR_CONTAINED", "Invalid access of peer GPU memory over nvlink or a hardware error"},
    {400, "CUDA_ERROR_INVALID_HANDLE", "invalid resource handle"},
    {500, "CUDA_ERROR_NOT_FOUND", "named symbol not found"},
    {600, "CUDA_ERROR_NOT_READY", "device not ready"},
    {700, "CUDA_ERROR_ILLEGAL_ADDRESS", "an illegal memory access was encountered"},
    {701, "CUDA_ERROR_LAUNCH_OUT_OF_RESOURCES", "too many resources requested for launch"},
    {719, "CUDA_ERROR_LAUNCH_FAILED", "unspecified launch failure"},
    {803, "CUDA_ERROR_SYSTEM_DRIVER_MISMATCH", "system has unsupported display driver / cuda driver combination"},
    {900, "CUDA_ERROR_STREAM_CAPTURE_UNSUPPORTED", "operation not permitted when stream is capturing"},
    {901, "CUDA_ERROR_STREAM_CAPTURE_INVALIDATED", "operation failed due to a previous error during capture"},
    {910, "CUDA_ERROR_GRAPH_EXEC_UPDATE_FAILURE", "the graph update was not performed"},
    {999, "CUDA_ERROR_UNKNOWN", "unknown error"},
};

const ErrorText* find_error(int result) {
  for (const ErrorText& error : kErrors) {
    if (error.result == result) return &error;
  }
  return nullptr;
}

/// The value of a device's attribute, or -1 for those that relume does not ask for.
int attribute(const Settings& settings, int attribute) {
  switch (attribute) {
    case 16: return 2;    // multiprocessors
    case 39: return 128;  // threads of a multiprocessor
    case 20: return settings.prohibited ? 2 : 0;
    case 75: return settings.capability / 10;
    case 76: return settings.capability % 10;
    case 83: return settings.managed ? 1 : 0;
    case 89: return settings.concurrent ? 1 : 0;
    default: return -1;
  }
}

/// Calls body(state) if there is such a device.
template <typename F>
int with_device(const char* function, int device, const F& body) {
  return without_context(function, [&](State& state) {
    if (!state.initialized) return kNotInitialized;
    if (device < 0 || device >= state.settings.devices) return kInvalidDevice;
    return body(state);
  });
}

int release_context(const char* function, int device) {
  return with_device(function, device, [&](State& state) {
    Context& context = state.contexts[device];
    if (context.retained == 0) return kInvalidContext;
    if (--context.retained == 0) {
      state.contexts.erase(device);
      if (state.contexts.empty()) state.end_contexts();
    }
    return kSuccess;
  });
}

}  // namespace

extern "C" {

void relume_stub_configure(const char* text) {
  State& state = State::get();
  const std::lock_guard lock(state.mutex);
  state.configure(text);
}

size_t relume_stub_objects(const char* kind) {
  State& state = State::get();
  const std::lock_guard lock(state.mutex);
  const std::string name = kind;
  if (name == "contexts") return state.contexts.size();
  if (name == "modules") return state.modules.size();
  if (name == "streams") return state.streams.size();
  if (name == "events") return state.events.size();
  if (name == "graphs") return state.graphs.size() + state.executions.size();
  if (name == "textures") return state.shared.size();
  if (name == "managed") return state.managed.count();
  if (name == "locked") return state.locked.size();
  if (name == "leaked") return state.leaked;
  if (name.starts_with("moved to ")) return state.moved_to[std::stoi(name.substr(9))];
  std::abort();
}

size_t relume_stub_calls(const char* function) {
  State& state = State::get();
  const std::lock_guard lock(state.mutex);
  return state.calls(function);
}

int cuGetErrorName(int result, const char** name) {
  const ErrorText* const error = find_error(result);
  *name = error ? error->name : nullptr;
  return error ? kSuccess : kInvalidValue;
}

int cuGetErrorString(int result, const char** text) {
  const ErrorText* const error = find_error(result);
  *text = error ? error->text : nullptr;
  return error ? kSuccess : kInvalidValue;
}

int cuInit(unsigned flags) {
  return without_context("cuInit", [&](State& state) {
    if (flags != 0) return kInvalidValue;
    if (state.settings.devices == 0) return kNoDevice;
    state.initialized = true;
    return kSuccess;
  });
}

int cuDriverGetVersion(int* version) {
  return without_context("cuDriverGetVersion", [&](State& state) {
    *version = state.settings.version;
    return kSuccess;
  });
}

int cuDeviceGetCount(int* count) {
  return without_context("cuDeviceGetCount", [&](State& state) {
    *count = state.settings.devices;
    return state.initialized ? kSuccess : kNotInitialized;
  });
}

int cuDeviceGet(int* device, int index) {
  return with_device("cuDeviceGet", index, [&](State&) {
    *device = index;
    return kSuccess;
  });
}

int cuDeviceGetName(char* name, int bytes, int device) {
  return with_device("cuDeviceGetName", device, [&](State&) {
    const std::string text = "Stub GPU " + std::to_string(device);
    if (static_cast<size_t>(bytes) <= text.size()) return kInvalidValue;
    std::memcpy(name, text.c_str(), text.size() + 1);
    return kSuccess;
  });
}

int cuDeviceTotalMem_v2(size_t* bytes, int device) {
  return with_device("cuDeviceTotalMem_v2", device, [&](State& state) {
    *bytes = state.settings.memory_mib << 20;
    return kSuccess;
  });
}

int cuDeviceGetAttribute(int* value, int name, int device) {
  return with_device("cuDeviceGetAttribute", device, [&](State& state) {
    *value = attribute(state.settings, name);
    return *value < 0 ? kInvalidValue : kSuccess;
  });
}

int cuDevicePrimaryCtxRetain(Context** context, int device) {
  return with_device("cuDevicePrimaryCtxRetain", device, [&](State& state) {
    *context = &state.contexts[device];
    (*context)->device = device;
    ++(*context)->retained;
    return kSuccess;
  });
}

int cuDevicePrimaryCtxRelease(int device) { return release_context("cuDevicePrimaryCtxRelease", device); }
int cuDevicePrimaryCtxRelease_v2(int device) { return release_context("cuDevicePrimaryCtxRelease_v2", device); }

int cuCtxPushCurrent_v2(Context* context) {
  return without_context("cuCtxPushCurrent_v2", [&](State& state) {
    const auto exists = [&](const auto& known) { return &known.second == context; };
    if (std::none_of(state.contexts.begin(), state.contexts.end(), exists)) return kInvalidContext;
    current_contexts().push_back(context);
    return kSuccess;
  });
}

int cuCtxPopCurrent_v2(Context** context) {
  return without_context("cuCtxPopCurrent_v2", [&](State&) {
    if (current_contexts().empty()) return kInvalidContext;
    *context = current_contexts().back();
    current_contexts().pop_back();
    return kSuccess;
  });
}

}  // extern "C"
}  // namespace stub
