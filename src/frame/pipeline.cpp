#include "frame/pipeline.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "core/first_error.h"

namespace relume {
namespace {

[[noreturn]] void fail(std::string_view pass, const BufferId& buffer, const char* problem) {
  throw std::logic_error("pass '" + std::string(pass) + "', buffer '" + std::string(buffer.name) + "': " + problem);
}

/// Access to the declared buffers.
class DeclaredAccess final : public BufferAccess {
 public:
  explicit DeclaredAccess(const PassDeclaration& declaration)
      : pass_(declaration.name), moves_surfaces_(declaration.moves_surfaces) {
    for (const BufferDescription& buffer : declaration.owns) written_.push_back(buffer.id);
    for (const auto* list : {&declaration.writes, &declaration.writes_if_any})
      written_.insert(written_.end(), list->begin(), list->end());
    for (const auto* list : {&declaration.reads, &declaration.reads_if_any})
      read_.insert(read_.end(), list->begin(), list->end());
  }
  void check_read(const BufferId& buffer) const override {
    if (!has(read_, buffer) && !has(written_, buffer)) fail(pass_, buffer, "it reads the buffer without declaring it");
  }
  void check_write(const BufferId& buffer) const override {
    if (!has(written_, buffer)) fail(pass_, buffer, "it writes the buffer without declaring it");
  }
  void check_move(const BufferId& buffer) const override {
    if (!moves_surfaces_) fail(pass_, buffer, "it moves the buffer without declaring it");
  }

 private:
  static bool has(const std::vector<BufferId>& list, const BufferId& buffer) {
    return std::find(list.begin(), list.end(), buffer) != list.end();
  }
  std::string pass_;
  bool moves_surfaces_;
  std::vector<BufferId> read_;
  std::vector<BufferId> written_;
};

}  // namespace

void Pipeline::add(std::unique_ptr<Pass> pass) {
  const PassDeclaration declaration = pass->declaration();
  const auto after = std::find_if(passes_.begin(), passes_.end(),
                                  [&](const auto& other) { return other->declaration().stage > declaration.stage; });
  access_.insert(access_.begin() + (after - passes_.begin()), std::make_unique<DeclaredAccess>(declaration));
  passes_.insert(after, std::move(pass));
}

void Pipeline::check() const {
  struct Known {
    BufferId id;
    bool lasting;
    bool written;
  };
  std::vector<Known> known;
  const auto find = [&](const BufferId& id) {
    return std::find_if(known.begin(), known.end(), [&](const Known& k) { return k.id.name == id.name; });
  };
  const std::vector<PassDeclaration> list = declarations();
  for (const PassDeclaration& pass : list) {
    for (const BufferDescription& b : pass.owns) {
      if (find(b.id) != known.end()) fail(pass.name, b.id, "another pass owns it");
      known.push_back({b.id, b.persistent || b.double_buffered, false});
    }
  }
  for (const PassDeclaration& pass : list) {
    const auto check_type = [&](const BufferId& id, const BufferId& owned) {
      if (id != owned) fail(pass.name, id, "its elements have another type than the owner's");
    };
    const auto read = [&](const BufferId& id, bool optional) {
      const auto buffer = find(id);
      if (buffer == known.end() && optional) return;
      if (buffer == known.end()) fail(pass.name, id, "it reads a buffer that no pass owns");
      check_type(id, buffer->id);
      if (!buffer->lasting && !buffer->written)
        fail(pass.name, id, "it reads a buffer that no earlier pass has written");
    };
    const auto write = [&](const BufferId& id, bool optional) {
      const auto buffer = find(id);
      if (buffer != known.end()) {
        check_type(id, buffer->id);
        buffer->written = true;
      } else if (!optional) {
        fail(pass.name, id, "it writes a buffer that no pass owns");
      }
    };
    for (const BufferId& id : pass.reads) read(id, false);
    for (const BufferId& id : pass.reads_if_any) read(id, true);
    for (const BufferId& id : pass.writes) write(id, false);
    for (const BufferId& id : pass.writes_if_any) write(id, true);
    for (const BufferDescription& b : pass.owns) find(b.id)->written = true;
  }
}

void Pipeline::add_buffers(BufferTable& table) const {
  for (const PassDeclaration& pass : declarations()) {
    for (const BufferDescription& buffer : pass.owns) table.add(buffer);
  }
}

bool Pipeline::run(const FrameContext& frame, const std::function<void(const std::string&)>& after_pass) {
  FrameContext own = frame;
  for (size_t i = 0; i < passes_.size(); ++i) {
    bool complete = false;
    try {
      complete = run_pass(i, own);
      if (complete && after_pass) after_pass(std::string(passes_[i]->declaration().name));
    } catch (...) {
      FirstError errors;
      errors.add_current();
      errors.attempt([&] { abandon(i); });
      errors.rethrow();
    }
    if (complete) continue;
    abandon(i);
    return false;
  }
  return true;
}

void Pipeline::abandon(size_t last) {
  FirstError errors;
  for (size_t i = last + 1; i-- > 0;) errors.attempt([&] { passes_[i]->abandon(); });
  errors.rethrow();
}

bool Pipeline::run_pass(size_t i, FrameContext& frame) {
  if (passes_[i]->commits()) {
    if (frame.stop.stop_requested()) return false;
    frame.stop = {};
  }
  return passes_[i]->run(frame.limited_to(*access_[i]));
}

uint32_t Pipeline::longest_epoch() const {
  uint32_t longest = 0;
  for (const auto& pass : passes_) {
    const uint32_t own = pass->longest_epoch();
    if (own > 0) longest = longest > 0 ? std::min(longest, own) : own;
  }
  return longest;
}

bool Pipeline::stops_late() const {
  // Passes of the present stage change the image, but none of them stops.
  return std::any_of(passes_.begin(), passes_.end(), [](const auto& pass) {
    const PassDeclaration declaration = pass->declaration();
    return declaration.stage == Stage::denoise || declaration.stage == Stage::allocate || declaration.moves_surfaces;
  });
}

bool Pipeline::keeps_to_pixels() const {
  return std::all_of(passes_.begin(), passes_.end(), [](const auto& pass) { return pass->keeps_to_pixels(); });
}

uint32_t Pipeline::correlated_frames() const {
  uint32_t most = 1;
  for (const auto& pass : passes_) most = std::max(most, pass->correlated_frames());
  return most;
}

bool Pipeline::prepared() const {
  return std::all_of(passes_.begin(), passes_.end(), [](const auto& pass) { return pass->prepared(); });
}

size_t Pipeline::memory_bytes() const {
  size_t sum = 0;
  for (const auto& pass : passes_) sum += pass->memory_bytes();
  return sum;
}

std::vector<PassDeclaration> Pipeline::declarations() const {
  std::vector<PassDeclaration> list;
  for (const auto& pass : passes_) list.push_back(pass->declaration());
  return list;
}

std::vector<PassStatistic> Pipeline::statistics() const {
  std::vector<PassStatistic> all;
  for (const auto& pass : passes_) {
    const std::string prefix = std::string(pass->declaration().name) + ".";
    for (const PassStatistic& figure : pass->statistics()) all.push_back({prefix + figure.name, figure.value});
  }
  return all;
}

std::vector<PassRecords> Pipeline::records() const {
  std::vector<PassRecords> all;
  for (const auto& pass : passes_) {
    const std::string prefix = std::string(pass->declaration().name) + ".";
    for (PassRecords& records : pass->records()) {
      records.table.name.insert(0, prefix);
      all.push_back(std::move(records));
    }
  }
  return all;
}

std::vector<std::string> Pipeline::warnings() const {
  std::vector<std::string> all;
  for (const auto& pass : passes_) {
    for (std::string& warning : pass->warnings()) all.push_back(std::move(warning));
  }
  return all;
}

void Pipeline::save(std::ostream& out) const {
  for (const auto& pass : passes_) pass->save(out);
}

void Pipeline::load(std::istream& in) {
  for (const auto& pass : passes_) pass->load(in);
}

}  // namespace relume
