#include "scene_io/mitsuba/mitsuba_document.h"

#include <algorithm>

#include <fmt/format.h>

#include "relume/error.h"
#include "scene_io/mitsuba/mitsuba_xml.h"

namespace relume::mitsuba {
namespace {

void link(Document& document, const std::map<std::string, Object*>& ids) {
  for (Object& object : document.objects) {
    for (Child& child : object.children) {
      if (child.object != nullptr) continue;
      const auto found = ids.find(child.reference);
      if (found == ids.end())
        throw Error(fmt::format("{}: <ref> names the id '{}', which does not exist; correct it",
                                document.place_of(object), child.reference));
      child.object = found->second;
    }
  }
}

/// Checks that no object contains itself, and that none is nested too deeply, without recursion: `levels` grows until
/// all parents are above their children.
class NestingCheck {
 public:
  explicit NestingCheck(const Document& document) : document_(document) {}

  void run() {
    for (const Object& object : document_.objects) visit(object);
  }

 private:
  struct Step {
    const Object* object;
    size_t next = 0;  ///< child
  };

  void visit(const Object& start) {
    std::vector<Step> path = {{&start}};
    while (!path.empty()) {
      Step& step = path.back();
      if (path.size() > kMaxNesting) fail(start);
      if (step.next == 0 && heights_.count(step.object) > 0) {
        if (heights_[step.object] + path.size() > kMaxNesting) fail(start);
        path.pop_back();
      } else if (step.next < step.object->children.size()) {
        path.push_back({step.object->children[step.next++].object});
      } else {
        heights_[step.object] = height(*step.object);
        path.pop_back();
      }
    }
  }

  size_t height(const Object& object) {
    size_t height = 0;
    for (const Child& child : object.children) height = std::max(height, heights_[child.object] + 1);
    return height;
  }

  [[noreturn]] void fail(const Object& object) const {
    throw Error(fmt::format("{}: <{}> contains itself, or references nest deeper than {} levels; remove the cycle",
                            document_.place_of(object), object.tag, kMaxNesting));
  }

  const Document& document_;
  std::map<const Object*, size_t> heights_;
};

}  // namespace

std::string Document::place_of(const Object& object) const {
  return fmt::format("{}:{}", files[object.file], object.line);
}

Document read_document(std::span<const std::byte> file, Files& files, const std::string& place, Warnings& warnings) {
  Document document;
  XmlReader reader(document, files, warnings);
  reader.read_file(file, files.root(), place, nullptr);
  link(document, reader.ids());
  NestingCheck(document).run();
  return document;
}

}  // namespace relume::mitsuba
