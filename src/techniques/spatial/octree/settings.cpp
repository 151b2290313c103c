#include "techniques/spatial/octree/settings.h"

#include "techniques/spatial/octree/octree.h"
#include "techniques/spatial/octree/sample_stream.h"

namespace relume {

SettingList describe(OctreeSettings& s) {
  return {
      {"collapse",
       &s.collapse,
       "Eight sibling regions are joined if they receive fewer samples per frame than this",
       {.min = 1, .max = 1 << 24}},
      {"split",
       &s.split,
       "A region that receives more samples per frame than this is split in eight",
       {.min = 8, .max = 1 << 24}},
      {"scale", &s.scale,
       "Scale collapse and split, which are defined for 1920 x 1080 pixels, with the image size; no effect with count "
       "useful"},
      {"count", choice(s.count, {"all", "useful"}),
       "Samples that collapse and split count: all, or only those that the light cache or the quadtree of a region "
       "learns from, at any image size"},
      {"max-depth", &s.max_depth, "Maximum number of levels of the tree", {.min = 1, .max = kMaxOctreeDepth}},
      {"vertices",
       &s.vertices,
       "Vertices of a path that record samples to learn from",
       {.min = 1, .max = kMaxRecordedVertices}},
      {"jitter",
       &s.jitter,
       "Distance by which the look-up of a vertex's region is jittered, in edges of the region; hides region borders",
       {.min = 0, .max = 2}},
      {"longest-epoch",
       &s.longest_epoch,
       "Maximum length of the epochs of 1, 2, 4, ... frames that share one set of regions while nothing changes and a "
       "history accumulates; 1: regions change in every frame",
       {.min = 1, .max = 1 << 20}},
  };
}

}  // namespace relume
