// What the readers and writers of EXR files share: streams and errors of the OpenEXR library.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <exception>
#include <map>
#include <ostream>
#include <string>
#include <string_view>

#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>

#include "relume/error.h"

namespace relume::detail {

class StreamOutput : public Imf::OStream {
 public:
  StreamOutput(std::ostream& stream, const std::string& name) : OStream(name.c_str()), stream_(stream) {}

  void write(const char* source, int count) override {
    if (!stream_.write(source, count)) throw Error("the disk is full or the file cannot be written");
  }
  uint64_t tellp() override { return static_cast<uint64_t>(std::streamoff(stream_.tellp())); }
  void seekp(uint64_t position) override { stream_.seekp(static_cast<std::streamoff>(position)); }

 private:
  std::ostream& stream_;
};

/// The library's message, formatted as part of a sentence.
inline std::string one_line(const char* message) {
  std::string text(message);
  std::replace(text.begin(), text.end(), '\n', ' ');
  while (!text.empty() && (text.back() == '.' || text.back() == ' ')) text.pop_back();
  return text;
}

[[noreturn]] inline void fail_damaged(const std::string& name, const std::exception& e) {
  throw Error(fmt::format("{}: damaged EXR file ({}); export or copy it again", name, one_line(e.what())));
}

[[noreturn]] inline void fail_write(const std::string& name, const std::exception& e) {
  throw Error(
      fmt::format("{}: the EXR cannot be written ({}); check its name and attributes", name, one_line(e.what())));
}

inline std::map<std::string, std::string> string_attributes(const Imf::Header& header) {
  std::map<std::string, std::string> attributes;
  for (auto a = header.begin(); a != header.end(); ++a) {
    const auto* text = dynamic_cast<const Imf::StringAttribute*>(&a.attribute());
    if (text != nullptr && std::string_view(a.name()) != "type") attributes[a.name()] = text->value();
  }
  return attributes;
}

}  // namespace relume::detail
