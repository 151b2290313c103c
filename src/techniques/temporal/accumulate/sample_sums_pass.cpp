#include "techniques/temporal/accumulate/sample_sums_pass.h"

#include "techniques/temporal/accumulate/sample_sums.h"

namespace relume {

PassDeclaration SampleSumsPass::declaration() const {
  const auto sums = [](const BufferId& id, const char* help) {
    return BufferDescription{.id = id, .help = help, .persistent = true, .reset = Change::any};
  };
  PassDeclaration declaration{.name = "sample-sums",
                              .stage = Stage::present,
                              .owns = {sums(kSampleBlock, "sum of the samples since the last complete block"),
                                       sums(kRadianceSums, "exact sum of the samples of complete blocks")},
                              .reads = {kRadiance}};
  if (!surface_) return declaration;
  declaration.owns.push_back(sums(kSurfaceSums, "exact sum of albedo, normal and depth"));
  declaration.reads.insert(declaration.reads.end(), {kSurfaceAlbedo, kSurface.normal, kSurface.depth});
  return declaration;
}

bool SampleSumsPass::run(const FrameContext& frame) {
  SampleSumsKernel kernel;
  kernel.radiance = frame.read(kRadiance);
  kernel.block = frame.write(kSampleBlock);
  kernel.sums = frame.write(kRadianceSums);
  kernel.ends_block = frame.since_change % kBlockSamples + 1 == kBlockSamples;
  kernel.width = frame.width();
  // Cannot be cancelled: sums must change only in complete frames.
  frame.launch("sample-sums", kernel);
  if (!surface_) return true;
  SurfaceSumsKernel surface;
  surface.albedo = frame.read(kSurfaceAlbedo);
  surface.normal = frame.read(kSurface.normal);
  surface.depth = frame.read(kSurface.depth);
  surface.sums = frame.write(kSurfaceSums);
  surface.width = frame.width();
  frame.launch("sample-sums", surface);
  return true;
}

}  // namespace relume
