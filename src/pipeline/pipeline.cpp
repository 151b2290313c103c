#include "pipeline/pipeline.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace relume {

void Pipeline::add(std::unique_ptr<Pass> pass) {
  const Stage stage = pass->declaration().stage;
  const auto after = std::find_if(passes_.begin(), passes_.end(),
                                  [&](const auto& other) { return other->declaration().stage > stage; });
  passes_.insert(after, std::move(pass));
}

void Pipeline::check() const {
  struct Known {
    std::string name;
    bool lasting;
    bool written;
  };
  std::vector<Known> known;
  const auto find = [&](std::string_view name) {
    return std::find_if(known.begin(), known.end(), [&](const Known& k) { return k.name == name; });
  };
  const auto fail = [](const PassDeclaration& pass, std::string_view buffer, const char* problem) {
    throw std::logic_error("pass '" + std::string(pass.name) + "', buffer '" + std::string(buffer) + "': " + problem);
  };
  const std::vector<PassDeclaration> list = declarations();
  for (const PassDeclaration& pass : list) {
    for (const BufferDescription& b : pass.owns) {
      if (find(b.name) != known.end()) fail(pass, b.name, "another pass owns it");
      known.push_back({b.name, b.persistent || b.double_buffered, false});
    }
  }
  for (const PassDeclaration& pass : list) {
    for (const std::string_view name : pass.reads) {
      const auto buffer = find(name);
      if (buffer == known.end()) fail(pass, name, "it reads what no pass owns");
      if (!buffer->lasting && !buffer->written) fail(pass, name, "it reads what no earlier pass has written");
    }
    for (const std::string_view name : pass.writes) {
      if (find(name) == known.end()) fail(pass, name, "it writes what no pass owns");
      find(name)->written = true;
    }
    for (const BufferDescription& b : pass.owns) find(b.name)->written = true;
  }
}

void Pipeline::add_buffers(BufferTable& table) const {
  for (const PassDeclaration& pass : declarations()) {
    for (const BufferDescription& buffer : pass.owns) table.add(buffer);
  }
}

bool Pipeline::run(const FrameContext& frame) {
  return std::all_of(passes_.begin(), passes_.end(), [&](const auto& pass) { return pass->run(frame); });
}

bool Pipeline::adapts() const {
  return std::any_of(passes_.begin(), passes_.end(), [](const auto& pass) { return pass->adapts(); });
}

bool Pipeline::keeps_state() const {
  return std::any_of(passes_.begin(), passes_.end(), [](const auto& pass) { return pass->keeps_state(); });
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

std::vector<PassFigure> Pipeline::figures() const {
  std::vector<PassFigure> all;
  for (const auto& pass : passes_) {
    const std::string prefix = std::string(pass->declaration().name) + ".";
    for (const PassFigure& figure : pass->figures()) all.push_back({prefix + figure.name, figure.value});
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
