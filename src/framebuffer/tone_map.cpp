#include "framebuffer/tone_map.h"

#include "core/parallel.h"

namespace relume {

Image tone_map(const Image& image, ToneMap curve, float exposure) {
  Image result(image.width, image.height);
  parallel_for(image.height, [&](int y) {
    for (int x = 0; x < image.width; ++x) result.at(x, y) = tone_map(curve, exposure, image.at(x, y));
  });
  return result;
}

}  // namespace relume
