#include "scene_io/pbrt/pbrt_parameters.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "relume/error.h"

namespace relume::pbrt {
namespace {

void append_value(const Token& token, Parameter& parameter) {
  const bool is_truth = token.text == "true" || token.text == "false";
  if (is_truth && (parameter.type == "bool" || !token.quoted)) {
    parameter.numbers.push_back(token.text == "true");
  } else if (token.quoted) {
    parameter.strings.emplace_back(token.text);
  } else {
    parameter.numbers.push_back(number_of(token));
  }
}

Parameter declared(const Token& token, ColorSpace space) {
  constexpr std::string_view kSpace = " \t";
  const size_t type = std::min(token.text.find_first_not_of(kSpace), token.text.size());
  const size_t type_end = std::min(token.text.find_first_of(kSpace, type), token.text.size());
  const size_t name = std::min(token.text.find_first_not_of(kSpace, type_end), token.text.size());
  const size_t name_end = std::min(token.text.find_first_of(kSpace, name), token.text.size());
  if (name == name_end)
    fail(token.where, fmt::format("\"{}\" declares no parameter; write \"TYPE NAME\"", token.text.substr(0, 40)));
  Parameter parameter;
  parameter.type = token.text.substr(type, type_end - type);
  parameter.name = token.text.substr(name, name_end - name);
  parameter.where = token.where;
  parameter.space = space;
  return parameter;
}

}  // namespace

Bytes read_reference(const std::filesystem::path& file, const Location& where) {
  try {
    return read_file_bytes(file);
  } catch (const Error& error) {
    throw Error(error.code(), fmt::format("{}: {}", text_of(where), error.what()));
  }
}

float narrow(double value) {
  return std::fabs(value) > 3e38 ? std::copysign(kInfinity, static_cast<float>(value > 0 ? 1 : -1))
                                 : static_cast<float>(value);
}

ParameterList parse_parameters(Tokens& tokens, ColorSpace space) {
  ParameterList list;
  while (tokens.peek() && tokens.peek()->quoted) {
    Parameter parameter = declared(*tokens.next(), space);
    const Token first = tokens.require("a value");
    if (!first.is("[")) {
      append_value(first, parameter);
    } else {
      for (Token token = tokens.require("]"); !token.is("]"); token = tokens.require("]")) {
        append_value(token, parameter);
      }
    }
    list.push_back(std::move(parameter));
  }
  return list;
}

const Parameter* Parameters::find(std::string_view name, std::initializer_list<std::string_view> types) const {
  const auto is_wanted = [&](const Parameter& p) {
    return p.name == name && std::find(types.begin(), types.end(), p.type) != types.end();
  };
  const auto own = std::find_if(own_.begin(), own_.end(), is_wanted);
  if (own != own_.end()) {
    own->used = true;
    return &*own;
  }
  if (!defaults_) return nullptr;
  const auto shared = std::find_if(defaults_->begin(), defaults_->end(), [&](const auto& p) { return is_wanted(*p); });
  return shared == defaults_->end() ? nullptr : shared->get();
}

float Parameters::number(std::string_view name, float otherwise) const {
  const Parameter* p = find(name, {"float"});
  return p && !p->numbers.empty() ? narrow(p->numbers[0]) : otherwise;
}

int Parameters::integer(std::string_view name, int otherwise) const {
  const Parameter* p = find(name, {"integer"});
  return p && !p->numbers.empty() ? static_cast<int>(std::clamp(p->numbers[0], -2e9, 2e9)) : otherwise;
}

bool Parameters::boolean(std::string_view name, bool otherwise) const {
  const Parameter* p = find(name, {"bool"});
  return p && !p->numbers.empty() ? p->numbers[0] != 0 : otherwise;
}

std::string Parameters::string(std::string_view name, const std::string& otherwise) const {
  const Parameter* p = find(name, {"string"});
  return p && !p->strings.empty() ? p->strings[0] : otherwise;
}

Vec3 Parameters::point(std::string_view name, const Vec3& otherwise) const {
  const std::vector<Vec3> all = vectors3(name);
  return all.empty() ? otherwise : all[0];
}

std::vector<double> Parameters::numbers(std::string_view name) const {
  const Parameter* p = find(name, {"float", "integer"});
  return p ? p->numbers : std::vector<double>();
}

std::vector<std::string> Parameters::strings(std::string_view name) const {
  const Parameter* p = find(name, {"string"});
  return p ? p->strings : std::vector<std::string>();
}

template <typename V>
std::vector<V> Parameters::vectors(std::string_view name, std::initializer_list<std::string_view> types) const {
  const Parameter* p = find(name, types);
  if (!p) return {};
  constexpr auto kSize = static_cast<size_t>(V::length());
  if (p->numbers.size() % kSize != 0)
    fail(p->where,
         fmt::format("{} numbers of '{}' are no groups of {}; add the missing ones", p->numbers.size(), name, kSize));
  std::vector<V> result(p->numbers.size() / kSize);
  for (size_t i = 0; i < p->numbers.size(); ++i) result[i / kSize][static_cast<int>(i % kSize)] = narrow(p->numbers[i]);
  return result;
}

std::vector<Vec2> Parameters::vectors2(std::string_view name) const {
  return vectors<Vec2>(name, {"point2", "vector2", "float"});
}

std::vector<Vec3> Parameters::vectors3(std::string_view name) const {
  return vectors<Vec3>(name, {"point3", "vector3", "normal3", "point", "vector", "normal"});
}

void Parameters::warn_of_unused(const std::string& owner, Warnings& warnings) const {
  for (const Parameter& p : own_) {
    if (!p.used) warnings.add(fmt::format("parameter '{} {}' of {} is ignored", p.type, p.name, owner));
  }
}

}  // namespace relume::pbrt
