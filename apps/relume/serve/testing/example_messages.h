// Messages of every kind, for tests and as seeds of the fuzzer.
#pragma once

#include <string>
#include <vector>

namespace relume::serve::testing {

inline std::vector<std::string> example_messages() {
  std::vector<std::string> messages = {R"({"do":"hello","token":"0123456789abcdef0123456789abcdef"})",
                                       R"({"do":"ack","frame":7})",
                                       R"({"do":"fly","x":0,"y":0,"z":-1,"fast":true,"n":3})",
                                       R"({"do":"drag","pan":false,"x":0.25,"y":-0.5})",
                                       R"({"do":"wheel","notches":1})",
                                       R"({"do":"set","side":1,"name":"env","value":"1,1,1"})",
                                       R"({"do":"set","side":0,"name":"width","value":"640"})",
                                       R"({"do":"preset","side":0,"name":"preview"})",
                                       R"({"do":"buffer","name":"depth"})",
                                       R"({"do":"split-at","at":0.5})",
                                       R"({"do":"resize","width":640,"height":360})",
                                       R"({"do":"screenshot"})",
                                       R"({"do":"steer"})",
                                       R"({"do":"grant","viewer":2})",
                                       R"({"do":"still","n":4294967295})"};
  for (const char* verb : {"go", "store", "remove"})
    messages.push_back(R"({"do":"bookmark","verb":")" + std::string(verb) + R"(","slot":2})");
  for (const char* button :
       {"pause", "home", "split", "orbit", "frame", "animate", "darker", "brighter", "copy", "swap"})
    messages.push_back(R"({"do":"press","button":")" + std::string(button) + R"("})");
  return messages;
}

/// The texts in quotes in the examples, with their quotes: names of fields and kinds, and values.
inline std::vector<std::string> example_words() {
  std::vector<std::string> words;
  for (const std::string& message : example_messages()) {
    for (size_t at = message.find('"'); at != std::string::npos;) {
      const size_t end = message.find('"', at + 1) + 1;
      words.push_back(message.substr(at, end - at));
      at = message.find('"', end);
    }
  }
  return words;
}

}  // namespace relume::serve::testing
