// Settings of ReSTIR PT.
#pragma once

#include "techniques/reuse/reservoir/settings.h"

namespace relume {

/// How a path moves to another pixel.
enum class PathShiftKind : int {
  reconnection,  ///< its second vertex is connected to the other pixel's first
  replay,        ///< its random numbers are used again
  hybrid,        ///< replay up to the first pair of vertices that are connectible, which are then connected
};

/// Rule that decides which vertices are connectible.
enum class ConnectRuleKind : int {
  distance_2022,  ///< by roughness and distance ([Lin22])
  footprint,      ///< by the spread of the path's directions ([Lin26])
};

/// Weights with which reservoirs of paths combine.
enum class PathCorrection : int {
  exact,     ///< balance and pairwise weights; reservoirs end where their light may change
  lagging,   ///< the same, but reservoirs survive changes of lights and geometry
  basic,     ///< as lagging, with weights of [Bitterli20] that ignore occlusion
  constant,  ///< as lagging, with weights in proportion to confidence: no inverse shifts
};

/// Levels of textures beyond the primary hit.
enum class PathTextures : int {
  finest,  ///< full resolution
  cones,   ///< by ray cones, up to the vertex that shifts keep
};

struct RestirPtSettings {
  PathShiftKind shift = PathShiftKind::hybrid;
  ConnectRuleKind connect = ConnectRuleKind::footprint;
  PathCorrection correction = PathCorrection::exact;
  ReuseFeedback feedback = ReuseFeedback::spatial;
  int cap = 20;             ///< confidence of a history, in frames; 0: no temporal reuse
  int neighbours = 3;       ///< 0: no spatial reuse
  float radius = 20;        ///< of the neighbours, pixels
  bool reciprocal = false;  ///< whether neighbours come in pairs that share their shifts
  float duplication = 0;    ///< strength with which duplicates of a path shorten its history; 0: none
  PathTextures textures = PathTextures::finest;
  float roughness = 0.2f;     ///< minimum roughness of connectible vertices (distance_2022), as in glTF
  float distance = 0.1f;      ///< minimum distance of connectible vertices (distance_2022), metres
  float footprint = 0.0002f;  ///< minimum footprint of connectible vertices, relative to the primary hit's (footprint)
};

SettingList describe(RestirPtSettings& settings);

}  // namespace relume
