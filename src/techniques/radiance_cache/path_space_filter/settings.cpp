#include "techniques/radiance_cache/path_space_filter/settings.h"

#include <utility>

namespace relume {

SettingList describe(PathSpaceFilterSettings& s) {
  SettingList list = describe(s.grid);
  list.push_back(
      {"min-roughness",
       &s.min_roughness,
       "Roughness of the dominant lobe below which a surface is not filtered; the filter waits for the next vertex",
       {.min = 0, .max = 1, .biases = true}});
  list.push_back({"edge-rays",
                  &s.edge_rays,
                  "Camera rays per pixel at the edges of bright emitters, to measure their coverage; 0: only the "
                  "sample's own ray. With a denoiser, features.edge-rays applies instead",
                  {.min = 0, .max = 256}});
  list.push_back({"split",
                  &s.split,
                  "Filter light from diffuse and from specular lobes in cells of their own, with psf and apsf; diffuse "
                  "cells then ignore direction-bins and roughness-bins",
                  {.biases = true}});
  list.push_back({"refine",
                  &s.refine,
                  "Show cells of half the edge where they differ from the ordinary cell by more than this number of "
                  "standard errors (2 is a good value), with psf and apsf: sharper shadows; 0: never",
                  {.min = 0, .max = 100, .biases = true}});
  return list;
}

}  // namespace relume
