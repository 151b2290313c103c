#include "frame/cuda/driver.h"

#include <dlfcn.h>

#include <fmt/format.h>

#include "relume/error.h"

namespace relume::cuda {
namespace {

constexpr const char* kLibrary = "libcuda.so.1";

void* open_library(const std::string& library) {
  void* const handle = ::dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle) return handle;
  const char* const reason = ::dlerror();
  throw Error(ErrorCode::device, fmt::format("no CUDA driver: {}; install NVIDIA's driver, or use --device cpu",
                                             reason ? reason : fmt::format("{} cannot be loaded", library)));
}

/// Finds functions of a library.
class Finder {
 public:
  explicit Finder(void* library) : library_(library) {}

  template <typename Function>
  void operator()(std::string_view symbol, Function*& function) const {
    void* found = ::dlsym(library_, symbol.data());
    // Drivers before CUDA 11.0 have it under its first name.
    if (!found && symbol == "cuDevicePrimaryCtxRelease_v2") found = ::dlsym(library_, "cuDevicePrimaryCtxRelease");
    if (!found) {
      throw Error(ErrorCode::device, fmt::format("the CUDA driver has no function {}; install a driver for "
                                                 "CUDA {} or later, or use --device cpu",
                                                 symbol, version_text(kMinDriverVersion)));
    }
    function = reinterpret_cast<Function*>(found);
  }
  /// The same for a function that drivers may lack.
  template <typename Function>
  void find_optional(const char* symbol, Function*& function) const {
    function = reinterpret_cast<Function*>(::dlsym(library_, symbol));
  }

 private:
  void* library_;
};

/// Throws Error if a driver is too old. Old ones lack functions, so this comes before the search for them.
void check_version(void* library) {
  decltype(Driver::cuDriverGetVersion) get_version = nullptr;
  Finder{library}("cuDriverGetVersion", get_version);
  int version = 0;
  if (get_version(&version) != Result::success || version >= kMinDriverVersion) return;
  throw Error(ErrorCode::device,
              fmt::format("the CUDA driver supports CUDA {}, but relume needs {}; install a newer driver, or use "
                          "--device cpu",
                          version_text(version), version_text(kMinDriverVersion)));
}

}  // namespace

Driver load_driver(const std::string& library) {
  void* const handle = open_library(library);
  check_version(handle);
  const Finder find{handle};
  Driver driver;
#define RELUME_FIND(member, symbol) find(#symbol, driver.member);
  RELUME_CUDA_FUNCTIONS(RELUME_FIND)
#undef RELUME_FIND
#define RELUME_FIND(member, symbol) find.find_optional(#symbol, driver.member);
  RELUME_CUDA_GRAPH_FUNCTIONS(RELUME_FIND)
  RELUME_CUDA_TEXTURE_FUNCTIONS(RELUME_FIND)
#undef RELUME_FIND
  return driver;
}

#define RELUME_AND_HAS(member, symbol) &&member != nullptr
bool Driver::has_graphs() const { return true RELUME_CUDA_GRAPH_FUNCTIONS(RELUME_AND_HAS); }
bool Driver::has_textures() const { return true RELUME_CUDA_TEXTURE_FUNCTIONS(RELUME_AND_HAS); }
#undef RELUME_AND_HAS

const Driver& driver() {
  static const Driver loaded = load_driver(kLibrary);  // tried again after an error
  return loaded;
}

bool start(const Driver& driver) {
  const Result result = driver.cuInit(0);
  if (result == Result::no_device) return false;
  check(driver, result, "starting the CUDA driver");
  return true;
}

std::string describe(const Driver& driver, Result result) {
  const char* name = nullptr;
  const char* text = nullptr;
  if (driver.cuGetErrorName(result, &name) != Result::success) name = nullptr;
  if (driver.cuGetErrorString(result, &text) != Result::success) text = nullptr;
  if (!name) return fmt::format("error {}", static_cast<int>(result));
  return text ? fmt::format("{} ({})", name, text) : name;
}

std::string_view remedy(Result result) {
  switch (result) {
    case Result::out_of_memory:
    case Result::launch_out_of_resources: return "use a smaller image or scene, or end other programs that use the GPU";
    case Result::device_unavailable: return "end the program that uses the GPU exclusively, or use --device cpu";
    case Result::no_device: return "check that nvidia-smi lists a GPU, or use --device cpu";
    case Result::stub_library:
      return "remove the CUDA toolkit's stubs from LD_LIBRARY_PATH, so that the driver is found";
    case Result::invalid_ptx:
    case Result::unsupported_ptx_version:
    case Result::no_binary_for_device:
    case Result::jit_compiler_not_found: return "install a newer driver, or use --device cpu";
    case Result::jit_compilation_disabled: return "unset CUDA_DISABLE_PTX_JIT, or use --device cpu";
    case Result::system_not_ready: return "wait until NVIDIA's services run, or use --device cpu";
    case Result::system_driver_mismatch:
    case Result::compat_not_supported_on_device:
      return "restart the machine, so that the driver's library and kernel module have one version";
    case Result::launch_timeout: return "use a GPU without a display, or a smaller image";
    case Result::unknown: return "check that nvidia-smi works and that the kernel module nvidia_uvm is loaded";
    default: return "start relume again, or use --device cpu";
  }
}

void check(const Driver& driver, Result result, std::string_view action) {
  if (result == Result::success) return;
  throw Error(ErrorCode::device, fmt::format("{} failed: {}; {}", action, describe(driver, result), remedy(result)));
}

std::string version_text(int version) { return fmt::format("{}.{}", version / 1000, version % 1000 / 10); }

}  // namespace relume::cuda
