#include "support/technique_checks.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <nlohmann/json.hpp>

namespace relume::support {
namespace {

using Json = nlohmann::ordered_json;

CheckMotion motion_of(const std::string& name) {
  if (name == "none") return CheckMotion::none;
  if (name == "camera") return CheckMotion::camera;
  if (name == "lamp") return CheckMotion::lamp;
  throw std::runtime_error("\"motion\" is none, camera or lamp, not " + name);
}

void expect_keys(const Json& object, std::initializer_list<std::string_view> keys) {
  for (const auto& [key, value] : object.items()) {
    if (std::find(keys.begin(), keys.end(), key) == keys.end()) throw std::runtime_error("unknown key " + key);
  }
}

void add(const Json& json, TechniqueChecks& checks) {
  expect_keys(json, {"bias", "determinism", "settings"});
  const Json biases = json.value("bias", Json::object());
  for (const auto& [choice, bias] : biases.items()) checks.biases[choice] = bias.get<double>();
  const Json determinism = json.value("determinism", Json::object());
  for (const auto& [name, check] : determinism.items()) {
    expect_keys(check, {"settings", "frames_of_an_image"});
    checks.determinism.push_back({name, check.at("settings").dump(), check.value("frames_of_an_image", 3)});
  }
  const Json settings = json.value("settings", Json::object());
  for (const auto& item : settings.items()) {
    const Json& check = item.value();
    expect_keys(check, {"with", "others", "motion", "buffer", "why"});
    const auto text = [&](const char* name) { return check.value(name, std::string()); };
    checks.settings.push_back(
        {item.key(), text("with"), text("others"), motion_of(check.value("motion", "none")), text("buffer")});
  }
}

TechniqueChecks read_all() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(RELUME_SOURCE_DIR "/src/techniques")) {
    if (entry.path().filename() == "checks.json") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  TechniqueChecks checks;
  for (const std::filesystem::path& file : files) {
    try {
      add(Json::parse(std::ifstream(file)), checks);
    } catch (const std::exception& error) {
      throw std::runtime_error(file.string() + ": " + error.what());
    }
  }
  return checks;
}

}  // namespace

const TechniqueChecks& technique_checks() {
  static const TechniqueChecks checks = read_all();
  return checks;
}

}  // namespace relume::support
