#include "scene_io/assimp/assimp_messages.h"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>

namespace relume {
namespace {

struct Translation {
  std::string_view part;  ///< part of assimp's message in lower case
  std::string_view problem;
};

/// The first match applies. The list covers several versions of assimp.
constexpr Translation kTranslations[] = {
    {"faces but no vertices", "its faces have no vertices"},
    {"no meshes", kNoTriangles},
    {"mnummeshes is 0", kNoTriangles},
    {"no faces", kNoTriangles},
    {"no vertices", kNoTriangles},
    {"no valid faces", kNoTriangles},
    {"no valid vertices", kNoTriangles},
    {"came out empty", kNoTriangles},
    {"empty or corrupt", "it is empty or damaged"},
    {"malformed xml", "its XML is malformed"},
    {"failed to parse", "its structure is damaged"},
    {"storage representation", "its content does not match its extension"},
    {"header is invalid", "its content does not match its extension"},
    {"no suitable reader", "its content does not match its extension"},
    {"nable to open", "the file cannot be opened; check its permissions"},
    {"failed to open", "the file cannot be opened; check its permissions"},
    {"format version", "its version of FBX is not supported; export it as FBX 2013 or convert it to glTF"},
    {"s a real number", "a number is expected"},
    {"cannot be converted into a value", "a number is expected"},
    {"ata index", "a face refers to a vertex that does not exist"},
    {"ertex index", "a face refers to a vertex that does not exist"},
    {"ace index", "a face refers to a vertex that does not exist"},
    {"out of range", "a length or an index in it is out of range"},
    {"number of components", "a vertex has too few or too many coordinates"},
    {"number of vertices", "a triangle has too few or too many vertices"},
    {"does not match position buffer", "a triangle has too few or too many vertices"},
    {"unable to resolve", "it refers to a part that does not exist"},
    {"too small", "the file is cut off"},
    {"too large", "a length in it goes beyond the end of the file"},
    {"end of file", "the file is cut off"},
    {"eof", "the file is cut off"},
    {"unexpected", "its structure is damaged"},
    {"dictionary found", "a section is missing"},
    {"required element", "a required entry is missing"},
};

/// "line 5: " if the message names a line, else empty.
std::string line_of(std::string_view message) {
  constexpr std::string_view kWord = "line ";
  const size_t at = message.find(kWord);
  if (at == std::string_view::npos) return {};
  const std::string_view rest = message.substr(at + kWord.size());
  const auto end = std::find_if_not(rest.begin(), rest.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
  return end == rest.begin() ? std::string() : fmt::format("line {}: ", std::string_view(rest.begin(), end));
}

/// " (near 'x y z')": start of the text that the message quotes; empty without a printable quotation.
std::string quotation_of(std::string_view message) {
  constexpr size_t kLongest = 24;
  const size_t begin = message.find('"');
  if (begin == std::string_view::npos) return {};
  std::string text(message.substr(begin + 1, message.rfind('"') - begin - 1));
  const auto shown = [](unsigned char c) { return c >= 0x20 && c < 0x7f; };
  text.erase(std::find_if_not(text.begin(), text.end(), shown), text.end());
  if (text.size() > kLongest) text = text.substr(0, kLongest) + "...";
  return text.empty() ? text : fmt::format(" (near '{}')", text);
}

}  // namespace

std::string explain_assimp_problem(std::string_view message) {
  std::string lower(message);
  std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
  const auto* known = std::find_if(std::begin(kTranslations), std::end(kTranslations),
                                   [&](const Translation& t) { return lower.find(t.part) != std::string::npos; });
  const bool is_known = known != std::end(kTranslations);
  const std::string_view problem = is_known ? known->problem : "the file's content is damaged or not supported";
  if (problem.find(';') != std::string_view::npos) return std::string(problem);  // already has a remedy
  return fmt::format("{}{}{}; export it again or convert it to glTF", line_of(message), problem,
                     is_known ? quotation_of(message) : std::string());
}

}  // namespace relume
