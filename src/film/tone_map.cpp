#include "film/tone_map.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace relume {

Image tone_map(const Image& image, ToneMap curve, float exposure) {
  Image result(image.width, image.height);
  tbb::parallel_for(tbb::blocked_range<size_t>(0, image.pixels.size(), 4096), [&](const auto& range) {
    for (size_t i = range.begin(); i != range.end(); ++i) result.pixels[i] = tone_map(curve, exposure, image.pixels[i]);
  });
  return result;
}

}  // namespace relume
