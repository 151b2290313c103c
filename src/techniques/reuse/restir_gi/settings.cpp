#include "techniques/reuse/restir_gi/settings.h"

#include "techniques/reuse/reservoir/reuse_settings.h"

namespace relume {

SettingList describe(RestirGiSettings& s) {
  SettingList list = {
      {"correction",
       choice(s.correction, {"exact", "lagging", "basic"}),
       "Weights of reservoirs. exact: with shadow rays, and without history where lights or geometry change: unbiased; "
       "lagging: histories survive such changes, with bias there; basic: the same without shadow rays in the weights, "
       "darker near edges",
       {.biases = true}},
  };
  declare_reuse(
      list, s,
      "Number of neighbouring pixels whose reservoirs a pixel reuses, with up to two shadow rays each; 0: none");
  list.insert(list.end(),
              {
                  {"roughness",
                   &s.roughness,
                   "Minimum roughness of glossy surfaces whose pixels reuse samples; pixels of smoother surfaces keep "
                   "their own sample",
                   {.min = 0, .max = 1}},
                  {"reuse-glossy",
                   &s.reuse_glossy,
                   "Reuse samples on surfaces with glossy lobes of at least restir-gi.roughness, too, as if these "
                   "surfaces reflected the same light in all directions; off: only samples on Lambertian surfaces",
                   {.biases = true}},
                  {"jacobian",
                   &s.jacobian,
                   "Samples are not reused where their solid angle would change by more than this factor",
                   {.min = 1, .max = 1e6}},
                  {"validate",
                   &s.validate,
                   "Number of frames after which the path of a reused sample is traced again, to follow changes, with "
                   "correction lagging or basic; 0: never. No effect with estimator bdpt or vcm, lights vlc, neeat "
                   "or mcls, guide cdq or mcpg, or cache apg, apsf+apg or sharc",
                   {.min = 0, .max = 1000, .biases = true}},
              });
  return list;
}

}  // namespace relume
