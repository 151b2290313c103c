#include "scene/emission_mask.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace relume {

EmissionMask::EmissionMask(const TextureSampler& texture)
    : width_(texture.record().width),
      height_(texture.record().height),
      wrap_u_(texture.record().wrap_u),
      wrap_v_(texture.record().wrap_v),
      sums_(static_cast<size_t>(width_ + 1) * static_cast<size_t>(height_ + 1)) {
  const auto row = [&](int y) { return sums_.data() + static_cast<size_t>(y) * static_cast<size_t>(width_ + 1); };
  parallel_for(height_, [&](int y) {
    uint32_t* sums = row(y + 1);
    for (int x = 0; x < width_; ++x) {
      const Rgb value(texture.texel(0, x, y));
      sums[x + 1] = sums[x] + (is_black(value) ? 0u : 1u);
    }
  });
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x <= width_; ++x) row(y + 1)[x] += row(y)[x];
  }
}

int EmissionMask::texel_ranges(float low, float high, int size, WrapMode wrap, Range (&ranges)[2]) {
  ranges[0] = {0, size};
  // Look-ups wrap first and interpolate coordinates, so rounding may reach one texel further.
  const float first = std::floor(low * static_cast<float>(size) - 0.5f) - 1.0f;
  const float last = std::floor(high * static_cast<float>(size) - 0.5f) + 2.0f;
  constexpr float kFarthest = 1e5f;
  if (!(std::fabs(first) < kFarthest && std::fabs(last) < kFarthest) || last - first + 1.0f >= static_cast<float>(size))
    return 1;
  int begin = static_cast<int>(first);
  int end = static_cast<int>(last) + 1;
  const bool inside = begin >= 0 && end <= size;
  if (inside || wrap == WrapMode::clamp) {
    ranges[0] = {std::clamp(begin, 0, size - 1), std::clamp(end, 1, size)};
    return 1;
  }
  if (wrap != WrapMode::repeat) return 1;  // mirrored: the full range
  begin = (begin % size + size) % size;
  end = begin + static_cast<int>(last - first) + 1;
  ranges[0] = {begin, std::min(end, size)};
  ranges[1] = {0, end - size};
  return end > size ? 2 : 1;
}

uint32_t EmissionMask::count(const Range& x, const Range& y) const {
  const auto sum = [&](int column, int row) {
    return sums_[static_cast<size_t>(row) * static_cast<size_t>(width_ + 1) + static_cast<size_t>(column)];
  };
  return sum(x.end, y.end) - sum(x.first, y.end) - sum(x.end, y.first) + sum(x.first, y.first);
}

bool EmissionMask::may_emit(const Vec2 (&uv)[3]) const {
  const Vec2 low = glm::min(uv[0], glm::min(uv[1], uv[2]));
  const Vec2 high = glm::max(uv[0], glm::max(uv[1], uv[2]));
  Range columns[2];
  Range rows[2];
  const int column_ranges = texel_ranges(low.x, high.x, width_, wrap_u_, columns);
  const int row_ranges = texel_ranges(low.y, high.y, height_, wrap_v_, rows);
  for (int c = 0; c < column_ranges; ++c) {
    for (int r = 0; r < row_ranges; ++r) {
      if (count(columns[c], rows[r]) > 0) return true;
    }
  }
  return false;
}

}  // namespace relume
