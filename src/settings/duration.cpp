#include "settings/duration.h"

#include <charconv>
#include <cmath>
#include <string>

#include "relume/error.h"

namespace relume {
namespace {

/// Removes the unit at the start of `text` and returns its length in seconds; 0 for an unknown unit.
double take_unit(std::string_view& text) {
  constexpr struct {
    std::string_view name;
    double seconds;
  } kUnits[] = {{"ms", 1e-3}, {"min", 60}, {"m", 60}, {"s", 1}, {"h", 3600}};  // "ms" and "min" before "m"
  for (const auto& unit : kUnits) {
    if (!text.starts_with(unit.name)) continue;
    text.remove_prefix(unit.name.size());
    return unit.seconds;
  }
  return 0;
}

}  // namespace

double parse_duration_s(std::string_view text, std::string_view place) {
  const Error error(std::string(place) + ": '" + std::string(text) +
                    "' is not a duration; write 10s, 500ms, 2min or 1h30min");
  std::string_view rest = text;
  if (rest.empty()) throw error;
  double total = 0;
  while (!rest.empty()) {
    double number = 0;
    const auto [end, failure] =
        std::from_chars(rest.data(), rest.data() + rest.size(), number, std::chars_format::fixed);
    if (failure != std::errc{} || !std::isfinite(number) || std::signbit(number)) throw error;
    const bool first = rest.data() == text.data();
    rest.remove_prefix(static_cast<size_t>(end - rest.data()));
    if (first && rest.empty()) return number;
    const double unit = take_unit(rest);
    if (unit == 0) throw error;
    total += number * unit;
  }
  return total;
}

}  // namespace relume
