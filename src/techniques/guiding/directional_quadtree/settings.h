// Settings of the directional quadtree.
#pragma once

#include "settings/setting.h"

namespace relume {

enum class QuadtreeBits : int { b32, b64, b96, b128 };
enum class QuadtreeSampling : int { bottom_up, stratified };

struct DirectionalQuadtreeSettings {
  QuadtreeBits bits = QuadtreeBits::b128;
  float bsdf_fraction = 0.5f;
  bool learn_fraction = false;  ///< whether regions learn their own fraction
  int candidates = 1;           ///< directions of which one is resampled at glossy vertices
  int migrations = 1;
  float stability = 0.1f;
  int pool = 0;      ///< number of samples from which a region learns from its own only
  int memory = 0;    ///< m: sums keep m / (m + 1) of their value per frame
  float spread = 0;  ///< share of a leaf's sum that is also added around it
  QuadtreeSampling sampling = QuadtreeSampling::bottom_up;
  bool importance = false;  ///< whether light subpaths are guided by trees that learn importance
  bool view = false;        ///< whether to fill the layer "directions" for the point at:
  float view_x = 0.5f;
  float view_y = 0.5f;
};

SettingList describe(DirectionalQuadtreeSettings& settings);

}  // namespace relume
