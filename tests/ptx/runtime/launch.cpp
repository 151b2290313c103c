#include "runtime/launch.h"

#include <cfenv>
#include <string>

#include "runtime/block.h"

namespace ptx {
namespace {

/// The processor's default arithmetic: rounding to nearest, with denormal numbers.
class DefaultArithmetic {
 public:
  DefaultArithmetic() {
    std::fegetenv(&saved_);
    std::fesetenv(FE_DFL_ENV);
  }
  ~DefaultArithmetic() { std::fesetenv(&saved_); }
  DefaultArithmetic(const DefaultArithmetic&) = delete;
  DefaultArithmetic& operator=(const DefaultArithmetic&) = delete;

 private:
  std::fenv_t saved_;
};

uint64_t volume(const Dim& d) { return uint64_t{d.x} * d.y * d.z; }

template <typename T>
const T& named(const std::vector<T>& all, const std::string& name, const char* what) {
  for (const T& one : all) {
    if (one.name == name) return one;
  }
  throw Fault("the module has no " + std::string(what) + " '" + name + "'");
}

}  // namespace

const Entry& Module::entry(const std::string& name) const { return named(entries, name, "entry"); }
const Symbol& Module::symbol(const std::string& name) const { return named(symbols, name, "variable"); }

void run_block(const Module& module, const Entry& entry, const Launch& launch, void* const* parameters,
               const Dim& block) {
  if (volume(launch.block) == 0 || volume(launch.block) > kMaxBlockThreads) {
    throw Fault("a block has 1 to " + std::to_string(kMaxBlockThreads) + " threads, not " +
                std::to_string(volume(launch.block)));
  }
  const DefaultArithmetic arithmetic;
  Block(module, entry, launch, parameters, block).run();
}

void run_grid(const Module& module, const Entry& entry, const Launch& launch, void* const* parameters) {
  Random random(launch.seed);
  for (const uint32_t i : shuffled_indices(static_cast<uint32_t>(volume(launch.grid)), random)) {
    const Dim block{i % launch.grid.x, i / launch.grid.x % launch.grid.y, i / launch.grid.x / launch.grid.y};
    run_block(module, entry, launch, parameters, block);
  }
}

}  // namespace ptx
