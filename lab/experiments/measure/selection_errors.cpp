#include "experiments/measure/selection_errors.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "experiments/setup/named.h"

namespace relume {
namespace {

/// Geometric mean of `of(scene).value`, a ratio in each scene, with its interval over the scenes.
template <typename Of>
Ratio over_scenes(const std::vector<SelectionErrors>& scenes, const Of& of) {
  std::vector<double> quotients;
  for (const SelectionErrors& scene : scenes) quotients.push_back(of(scene).value);
  return geometric_mean(quotients);
}

Ratio gain(const SelectionErrors& scene, std::string_view a, std::string_view b) {
  return error_ratio(named(scene.errors, "contender", a).mse[0], named(scene.errors, "contender", b).mse[0]);
}

}  // namespace

Ratio mean_gain(const std::vector<SelectionErrors>& scenes, std::string_view a, std::string_view b) {
  return over_scenes(scenes, [&](const SelectionErrors& scene) { return gain(scene, a, b); });
}

TableBlock bases_table(const std::vector<SelectionErrors>& bases, std::string_view tree, std::string_view lists) {
  TableBlock block{
      fmt::format("Bases ({})", bases.size()),
      "Factor by which the mean squared error of single frames is lower than with the light tree and with exact lists, "
      "at equal samples; the last column multiplies the error by the frame time. Geometric means over the bases with "
      "95 % intervals.",
      "lights",
      {{"times lower than the light tree", "", Better::higher},
       {"least and most", "", Better::higher},
       {"times lower than exact lists", "", Better::higher},
       {"tree, times time", "", Better::higher}},
      {}};
  int color = 0;
  for (const AdaptedError& contender : bases.front().errors) {
    const Ratio of_tree = mean_gain(bases, tree, contender.name);
    const Ratio of_lists = mean_gain(bases, lists, contender.name);
    const Ratio time = over_scenes(bases, [&](const SelectionErrors& scene) {
      return equal_time_ratio(named(scene.errors, "contender", tree), named(scene.errors, "contender", contender.name));
    });
    double least = of_tree.value;
    double most = of_tree.value;
    for (const SelectionErrors& scene : bases) {
      least = std::min(least, gain(scene, tree, contender.name).value);
      most = std::max(most, gain(scene, tree, contender.name).value);
    }
    block.rows.push_back({contender.name,
                          color++,
                          {{to_text(of_tree), of_tree.value},
                           {fmt::format("{:.2f} to {:.2f}", least, most), least},
                           {to_text(of_lists), of_lists.value},
                           {to_text(time), time.value}}});
  }
  return block;
}

TableBlock rooms_table(const std::vector<RoomErrors>& rooms, std::string_view tree) {
  TableBlock block{"Rooms of the bases, by their lamps",
                   "Factor by which the mean squared error of single frames inside such rooms is lower than with the "
                   "light tree, at equal samples: geometric means over the bases with 95 % intervals.",
                   "rooms",
                   {},
                   {}};
  for (const AdaptedError& contender : rooms.front().bases.front().errors) {
    if (contender.name != tree) block.columns.push_back({contender.name, "", Better::none});
  }
  for (const RoomErrors& kind : rooms) {
    TableRow row{fmt::format("{} ({})", kind.kind, kind.bases.size()), kNeutralColor, {}, false};
    for (const TableColumn& column : block.columns) {
      const Ratio ratio = mean_gain(kind.bases, tree, column.title);
      row.cells.push_back({to_text(ratio), ratio.value});
    }
    block.rows.push_back(std::move(row));
  }
  return block;
}

}  // namespace relume
