#include "stub_driver.h"

#include <dlfcn.h>

#include <fstream>
#include <sstream>
#include <stdexcept>

#include "stub/control.h"

namespace relume::cuda::testing {
namespace {

constexpr const char* kLibrary = "libcuda.so.1";

/// A function that only the stub has.
template <typename Function>
Function* control(const char* name) {
  static void* const library = ::dlopen(kLibrary, RTLD_NOW);
  void* const found = library ? ::dlsym(library, name) : nullptr;
  if (!found) throw std::runtime_error("libcuda.so.1 is not the stub driver; set LD_LIBRARY_PATH as ctest does");
  return reinterpret_cast<Function*>(found);
}

}  // namespace

StubDriver::StubDriver(const std::string& settings) {
  configure(settings);
  driver_ = load_driver(kLibrary);
}

StubDriver::~StubDriver() { configure(""); }

void StubDriver::configure(const std::string& settings) {
  control<decltype(relume_stub_configure)>("relume_stub_configure")(settings.c_str());
}

size_t StubDriver::objects(const char* kind) {
  return control<decltype(relume_stub_objects)>("relume_stub_objects")(kind);
}

size_t StubDriver::calls(const char* function) {
  return control<decltype(relume_stub_calls)>("relume_stub_calls")(function);
}

void StubDriver::make_texture(unsigned name, size_t row_bytes, size_t rows) {
  control<decltype(relume_stub_make_texture)>("relume_stub_make_texture")(name, row_bytes, rows);
}

const void* StubDriver::texture(unsigned name) {
  return control<decltype(relume_stub_texture)>("relume_stub_texture")(name);
}

std::string test_device_code() {
  std::ifstream file(RELUME_TEST_PTX);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

}  // namespace relume::cuda::testing
