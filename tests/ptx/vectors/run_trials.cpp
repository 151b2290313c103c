// run_trials INPUT OUTPUT: launches the trials that suite.py wrote, and writes their results. Formats: suite.py.
#include <cstdint>
#include <exception>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include "runtime/launch.h"

namespace ptx {

extern const Module trials;

namespace {

/// Launches the rows of a trial, as many at once as a block has threads. Returns the message of a Fault, or nothing.
std::string run(const std::string& name, uint32_t rows, uint32_t threads, std::vector<uint64_t>& in,
                std::vector<uint64_t>& out) {
  Launch launch;
  launch.block.x = threads;
  const Entry& entry = trials.entry(name);
  try {
    for (uint32_t row = 0; row < rows; row += threads) {
      alignas(16) unsigned char memory[64] = {};
      uint64_t addresses[] = {reinterpret_cast<uint64_t>(in.data() + in.size() / rows * row),
                              reinterpret_cast<uint64_t>(out.data() + out.size() / rows * row),
                              reinterpret_cast<uint64_t>(memory)};
      void* const parameters[] = {&addresses[0], &addresses[1], &addresses[2]};
      run_grid(trials, entry, launch, parameters);
    }
  } catch (const Fault& fault) {
    return fault.what();
  }
  return "";
}

int run_all(const char* input, const char* output) {
  std::ifstream from(input, std::ios::binary);
  std::ofstream to(output, std::ios::binary);
  std::string name;
  uint32_t rows, threads, inputs, outputs;
  while (from >> name >> rows >> threads >> inputs >> outputs) {
    from.get();
    std::vector<uint64_t> in(size_t{rows} * inputs);
    std::vector<uint64_t> out(size_t{rows} * outputs);
    from.read(reinterpret_cast<char*>(in.data()), static_cast<std::streamsize>(8 * in.size()));
    to << run(name, rows, threads, in, out) << '\n';
    to.write(reinterpret_cast<const char*>(out.data()), static_cast<std::streamsize>(8 * out.size()));
  }
  to.close();
  return from.eof() && to ? 0 : 1;
}

}  // namespace
}  // namespace ptx

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "run_trials INPUT OUTPUT\n";
    return 2;
  }
  try {
    return ptx::run_all(argv[1], argv[2]);
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
}
