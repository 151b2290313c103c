#include "files/read_record.h"

#include <mutex>

namespace relume {
namespace {

// Global, because many threads load a scene without access to the record.
std::mutex g_mutex;
std::vector<ReadRecord*> g_records;

}  // namespace

ReadRecord::ReadRecord() {
  const std::scoped_lock lock(g_mutex);
  g_records.push_back(this);
}

ReadRecord::~ReadRecord() {
  const std::scoped_lock lock(g_mutex);
  std::erase(g_records, this);
}

std::vector<std::filesystem::path> ReadRecord::files() const {
  const std::scoped_lock lock(g_mutex);
  return files_;
}

void record_read(const std::filesystem::path& file) {
  const std::scoped_lock lock(g_mutex);
  for (ReadRecord* record : g_records) {
    if (record->known_.insert(file).second) record->files_.push_back(file);
  }
}

}  // namespace relume
