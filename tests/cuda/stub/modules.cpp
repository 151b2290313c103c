#include "stub/modules.h"

#include <algorithm>
#include <set>

namespace stub {
namespace {

std::set<std::string> entries_of(const std::string& text) {
  const std::string word = ".entry ";
  std::set<std::string> names;
  for (size_t at = text.find(word); at != std::string::npos; at = text.find(word, at)) {
    at += word.size();
    names.insert(text.substr(at, text.find_first_of("( \n", at) - at));
  }
  return names;
}

std::set<std::string> entries_of(const ptx::Module& module) {
  std::set<std::string> names;
  for (const ptx::Entry& entry : module.entries) names.insert(entry.name);
  return names;
}

}  // namespace

const ptx::Module* find_module(const std::string& text, std::string& message) {
  if (text.find(".version ") == std::string::npos) {
    message = "ptxas fatal   : Missing .version directive at start of file\nptxas fatal   : Ptx assembly aborted";
    return nullptr;
  }
  const std::set<std::string> names = entries_of(text);
  for (const ptx::Module* module : translated_modules()) {
    if (entries_of(*module) == names) return module;
  }
  message = "the stub driver has no translation of a module with " + std::to_string(names.size()) + " entries";
  return nullptr;
}

}  // namespace stub
