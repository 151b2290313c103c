#include "scene/mixtures.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "relume/error.h"

namespace relume {
namespace {

class MixtureCheck {
 public:
  MixtureCheck(size_t materials, const MixturePartsOf& parts_of, const std::string& place)
      : parts_of_(parts_of), place_(place), depths_(materials, kUnknown) {}

  void run() {
    for (size_t i = 0; i < depths_.size(); ++i) depth_of(i, kMaxMixDepth);
  }

 private:
  static constexpr int kUnknown = -1;

  /// Number of nested mixtures from a material inwards. Throws Error if it exceeds `most`.
  int depth_of(size_t material, int most) {
    int& depth = depths_[material];
    if (depth == kUnknown) depth = depth_of_parts(material, most);
    if (depth > most)
      throw Error(
          fmt::format("{}: material {} is part of itself, or more than {} mixtures are nested; change its parts",
                      place_, material, kMaxMixDepth));
    return depth;
  }

  int depth_of_parts(size_t material, int most) {
    const auto [first, second] = parts_of_(material);
    if (first == kNone && second == kNone) return 0;
    for (const Index part : {first, second}) {
      if (part < 0 || static_cast<size_t>(part) >= depths_.size())
        throw Error(
            fmt::format("{}: material {} mixes the missing material {}; use existing ones", place_, material, part));
    }
    if (most == 0) return 1;  // too deep
    return 1 +
           std::max(depth_of(static_cast<size_t>(first), most - 1), depth_of(static_cast<size_t>(second), most - 1));
  }

  const MixturePartsOf& parts_of_;
  const std::string& place_;
  std::vector<int> depths_;
};

}  // namespace

void check_mixtures(size_t materials, const MixturePartsOf& parts_of, const std::string& place) {
  MixtureCheck(materials, parts_of, place).run();
}

}  // namespace relume
