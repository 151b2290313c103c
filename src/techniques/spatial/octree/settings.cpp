#include "techniques/spatial/octree/settings.h"

#include "techniques/spatial/octree/octree.h"
#include "techniques/spatial/octree/sample_stream.h"

namespace relume {

SettingList describe(OctreeSettings& s) {
  return {
      {"collapse",
       &s.collapse,
       "Eight regions with fewer samples a frame than this together are joined",
       {.min = 1, .max = 1 << 24}},
      {"split", &s.split, "A region with more samples a frame than this is split in eight", {.min = 8, .max = 1 << 24}},
      {"scale", &s.scale, "The two numbers are meant for 1920 x 1080 pixels and scaled with the size of the image"},
      {"max-depth", &s.max_depth, "Levels of the tree", {.min = 1, .max = kMaxOctreeDepth}},
      {"vertices",
       &s.vertices,
       "Vertices of a path that leave samples to learn from",
       {.min = 1, .max = kMaxRecordedVertices}},
      {"jitter",
       &s.jitter,
       "How far from its place a vertex may take its region from, in edges of the region; hides borders",
       {.min = 0, .max = 2}},
      {"longest-epoch",
       &s.longest_epoch,
       "Frames of 1, 2, 4, ... that sample with the same regions and what they know, at most, while nothing changes "
       "and "
       "a history adds frames up; 1: these change in every frame",
       {.min = 1, .max = 1 << 20}},
  };
}

}  // namespace relume
