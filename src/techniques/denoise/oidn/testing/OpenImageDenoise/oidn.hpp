// Mock of the library for tests on machines without it: the names that relume uses, and a filter that halves the image.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <string>

namespace oidn {

enum class DeviceType { Default, CPU };
enum class Format { Float3 };
enum class Error { None, Unknown };

/// The latest calls.
struct Log {
  std::map<std::string, int> device;
  std::map<std::string, bool> flags;
  std::map<std::string, float*> images;
  size_t width = 0;
  size_t height = 0;
  bool device_committed = false;
  bool filter_committed = false;
  const char* failure = nullptr;  ///< message with which the next filter fails
};
inline Log log;

class FilterRef {
 public:
  void setImage(const char* name, void* data, Format, size_t width, size_t height) {
    log.images[name] = static_cast<float*>(data);
    log.width = width;
    log.height = height;
  }
  void set(const char* name, bool value) { log.flags[name] = value; }
  void commit() { log.filter_committed = true; }
  void execute() {
    for (size_t i = 0; i < 3 * log.width * log.height; ++i) log.images["output"][i] = 0.5f * log.images["color"][i];
  }
};

class DeviceRef {
 public:
  void set(const char* name, int value) { log.device[name] = value; }
  void set(const char* name, bool value) { log.flags[name] = value; }
  void commit() { log.device_committed = true; }
  FilterRef newFilter(const char*) { return {}; }
  Error getError(const char*& message) {
    message = log.failure;
    return log.failure ? Error::Unknown : Error::None;
  }
};

inline DeviceRef newDevice(DeviceType) { return {}; }

}  // namespace oidn
