// Linearly transformed cosines ([Heitz16]): lobes that a linear map turns into a cosine lobe. relume uses them to
// estimate the importance of lights, never for shading.
#pragma once

#include "core/array.h"
#include "core/vec.h"
#include "core/view.h"

namespace relume {

inline constexpr uint32_t kLtcTableSize = 24;

/// Inverse transform of a lobe, in the frame whose x-z plane contains the viewer: rows (a 0 b), (0 c 0), (d 0 1).
struct LtcMatrix {
  float a = 1;
  float b = 0;
  float c = 1;
  float d = 0;

  RELUME_HD float determinant() const { return c * (a - b * d); }
};

/// Fits to GGX reflection with height-correlated masking and F = 1, divided by its albedo. Columns are over
/// √(1 − cos θ) of the viewer, rows over r = √α from kLtcMinR to 1.
struct LtcTable {
  View<const LtcMatrix> entries;

  RELUME_HD LtcMatrix at(float cos_theta, float r) const;
};

inline constexpr float kLtcMinR = 0.1f;  ///< also used for smoother lobes

RELUME_HD inline LtcMatrix LtcTable::at(float cos_theta, float r) const {
  constexpr float kLast = static_cast<float>(kLtcTableSize - 1);
  const float x = saturate(safe_sqrt(1.0f - cos_theta)) * kLast;
  const float y = saturate((r - kLtcMinR) / (1.0f - kLtcMinR)) * kLast;
  const uint32_t i = static_cast<uint32_t>(relume::min(x, kLast - 1.0f));
  const uint32_t j = static_cast<uint32_t>(relume::min(y, kLast - 1.0f));
  const float fx = x - static_cast<float>(i);
  const float fy = y - static_cast<float>(j);
  const LtcMatrix* row = &entries[j * kLtcTableSize + i];
  const auto mix = [&](float LtcMatrix::*m) {
    const float low = lerp(row[0].*m, row[1].*m, fx);
    const float high = lerp(row[kLtcTableSize].*m, row[kLtcTableSize + 1].*m, fx);
    return lerp(low, high, fy);
  };
  return {mix(&LtcMatrix::a), mix(&LtcMatrix::b), mix(&LtcMatrix::c), mix(&LtcMatrix::d)};
}

/// The built-in table, for host code.
LtcTable ltc_table();

/// The table in the memory of `array`, which is filled if it is empty.
LtcTable ltc_table(Array<LtcMatrix>& array);

/// Density per solid angle of the transformed cosine in direction `w` (local, x-z plane through the viewer).
RELUME_HD inline float ltc_pdf(const LtcMatrix& m, const Vec3& w) {
  const Vec3 q(m.a * w.x + m.b * w.z, m.c * w.y, m.d * w.x + w.z);
  if (q.z <= 0.0f) return 0.0f;
  const float length2 = length_squared(q);
  return kInvPi * std::fabs(m.determinant()) * q.z / (length2 * length2);
}

}  // namespace relume
