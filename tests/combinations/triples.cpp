#include "combinations/triples.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <set>
#include <utility>

#include "core/hash.h"
#include "render/build_pipeline.h"
#include "settings/setting.h"
#include "support/test_name.h"

namespace relume::support {
namespace {

constexpr uint32_t kSeed = 40;
constexpr size_t kLeastChoices = 3;
constexpr size_t kMostChoices = 6;
constexpr uint32_t kMostDraws = 100'000;

/// Random numbers by index, the same in every run.
class Dice {
 public:
  size_t below(size_t n) { return static_cast<size_t>(to_unit_float(hash(count_++, kSeed)) * static_cast<float>(n)); }

 private:
  uint32_t count_ = 0;
};

/// Choices by slot, without the defaults.
std::vector<std::vector<Choice>> choices_by_slot() {
  RenderSettings defaults;
  std::vector<std::vector<Choice>> slots;
  for (const Setting& slot : describe_slots(defaults)) {
    std::vector<Choice> others;
    for (const Choice& choice : all_choices()) {
      if (choice.slot == slot.name && choice.value != to_string(slot) && choice.value != "oidn")
        others.push_back(choice);
    }
    slots.push_back(std::move(others));
  }
  return slots;
}

/// Half of the triples have three choices, a quarter four, and so on.
Triple draw(const std::vector<std::vector<Choice>>& slots, Dice& dice) {
  size_t count = kLeastChoices;
  while (count < kMostChoices && dice.below(2) == 1) ++count;
  std::vector<size_t> order(slots.size());
  std::iota(order.begin(), order.end(), size_t{0});
  for (size_t i = 0; i < count; ++i) std::swap(order[i], order[i + dice.below(order.size() - i)]);
  order.resize(count);
  std::sort(order.begin(), order.end());
  Triple triple;
  for (const size_t slot : order) triple.push_back(slots[slot][dice.below(slots[slot].size())]);
  return triple;
}

}  // namespace

std::vector<Triple> draw_triples(size_t count) {
  const std::vector<std::vector<Choice>> slots = choices_by_slot();
  std::vector<Triple> triples;
  std::set<std::string> known;
  Dice dice;
  for (uint32_t i = 0; i < kMostDraws && triples.size() < count; ++i) {
    Triple triple = draw(slots, dice);
    if (refusal(combine(RenderSettings{}, triple)).empty() && known.insert(triple_name(triple)).second)
      triples.push_back(std::move(triple));
  }
  return triples;
}

std::vector<Triple> covering(std::vector<Triple> triples, size_t count) {
  std::vector<Triple> result;
  std::set<std::string> covered;
  const auto new_choices = [&](const Triple& triple) {
    return std::count_if(triple.begin(), triple.end(),
                         [&](const Choice& choice) { return !covered.contains(triple_name({choice})); });
  };
  while (result.size() < count && !triples.empty()) {
    const auto best = std::max_element(triples.begin(), triples.end(), [&](const Triple& a, const Triple& b) {
      return new_choices(a) < new_choices(b);
    });
    for (const Choice& choice : *best) covered.insert(triple_name({choice}));
    result.push_back(std::move(*best));
    triples.erase(best);
  }
  return result;
}

RenderSettings combine(RenderSettings settings, const Triple& triple) {
  for (const Choice& choice : triple) settings = combine(settings, choice, choice);
  return settings;
}

std::string triple_name(const Triple& triple) {
  std::string name;
  for (const Choice& choice : triple) name += (name.empty() ? "" : "_") + choice.slot + "_" + choice.value;
  return test_name(name);
}

std::string command_of(const Triple& triple) {
  RenderSettings defaults;
  RenderSettings settings = combine(defaults, triple);
  const SettingList list = describe(settings);
  std::string command = "relume render cornell";
  for (const Setting* setting : differing_settings(list, describe(defaults)))
    command += " --" + setting->name + " " + to_string(*setting);
  return command;
}

}  // namespace relume::support
