// A translated PTX module, as the translator describes it at the end of its output.
#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace ptx {

/// What a device reports when a kernel fails: a trap, a misaligned address, a barrier that some threads never reach.
class Fault : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A kernel.
struct Entry {
  std::string name;
  void (*run)(unsigned char* const* parameters) = nullptr;  ///< runs the current thread
  std::vector<size_t> parameter_bytes;
  bool cooperative = false;  ///< its threads wait for others, so that they need stacks of their own
  bool shares = false;       ///< uses the module's shared memory
};

/// A variable of the module in global or constant memory. It starts with its initial value.
struct Symbol {
  std::string name;
  void* address = nullptr;
  size_t bytes = 0;
};

struct Module {
  std::vector<Entry> entries;
  std::vector<Symbol> symbols;
  size_t shared_bytes = 0;  ///< of the shared variables whose sizes are declared

  /// Throws Fault if there is none of that name.
  const Entry& entry(const std::string& name) const;
  const Symbol& symbol(const std::string& name) const;
};

}  // namespace ptx
