// compress IN OUT: compresses a file with Zstandard and writes the result as 64-bit numbers, separated by commas: the
// initial value of an array, which the library includes.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <zstd.h>

namespace {

/// Compressing takes seconds, decompressing milliseconds.
constexpr int kLevel = 19;

[[noreturn]] void fail(const std::string& problem) {
  std::fprintf(stderr, "compress: %s\n", problem.c_str());
  std::exit(1);
}

/// The compressed text, with zeros up to the next number.
std::vector<uint64_t> compressed(const std::string& text) {
  std::vector<uint64_t> numbers(ZSTD_compressBound(text.size()) / sizeof(uint64_t) + 1);
  const size_t bytes =
      ZSTD_compress(numbers.data(), numbers.size() * sizeof(uint64_t), text.data(), text.size(), kLevel);
  if (ZSTD_isError(bytes)) fail(ZSTD_getErrorName(bytes));
  numbers.resize((bytes + sizeof(uint64_t) - 1) / sizeof(uint64_t));
  std::memset(reinterpret_cast<char*>(numbers.data()) + bytes, 0, numbers.size() * sizeof(uint64_t) - bytes);
  return numbers;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) fail("expected two files: compress IN OUT");
  std::ifstream in(argv[1], std::ios::binary);
  const std::string text(std::istreambuf_iterator<char>(in), {});
  if (!in || text.empty()) fail(std::string(argv[1]) + " cannot be read");
  std::FILE* const out = std::fopen(argv[2], "w");
  if (!out) fail(std::string(argv[2]) + " cannot be written");
  for (const uint64_t number : compressed(text)) std::fprintf(out, "%#llx,\n", static_cast<unsigned long long>(number));
  if (std::fclose(out) != 0) fail(std::string(argv[2]) + " cannot be written");
}
