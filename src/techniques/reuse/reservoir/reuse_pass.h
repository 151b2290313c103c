// Shared by passes whose reservoirs move between pixels and frames: buffers, resets, access and inputs of kernels.
#pragma once

#include <string_view>
#include <vector>

#include "frame/pass.h"
#include "techniques/reuse/reservoir/history_source.h"
#include "techniques/reuse/reservoir/neighbours.h"
#include "techniques/reuse/reservoir/receiver.h"
#include "techniques/reuse/reservoir/reuse_image.h"
#include "techniques/temporal/reprojection/backward_buffers.h"

namespace relume {

/// Changes that end the reservoirs of the previous frame in every mode.
inline constexpr Change kEndsReservoirs = Change::materials | Change::settings | Change::light_list;

/// Buffers of one kind of reservoirs: those of this frame, and their history with its receivers.
template <typename Sample>
struct ReuseBuffers {
  BufferKey<Reservoir<Sample>> reservoirs;  ///< before the reuse of neighbouring pixels
  BufferKey<Reservoir<Sample>> history;     ///< that the next frame reuses
  BufferKey<ReceiverRecord> receivers;      ///< primary hits of the reservoirs
  std::string_view content;                 ///< of the reservoirs, for help texts
};

/// Descriptions of these buffers, for the pass that owns them. `reset`: changes that end reservoirs.
std::vector<BufferDescription> reuse_descriptions(const BufferId& reservoirs, const BufferId& history,
                                                  const BufferId& receivers, std::string_view content, Change reset);
template <typename Sample>
std::vector<BufferDescription> reuse_descriptions(const ReuseBuffers<Sample>& buffers, Change reset) {
  return reuse_descriptions(buffers.reservoirs, buffers.history, buffers.receivers, buffers.content, reset);
}

/// Adds the surfaces that histories and neighbours need to the buffers that the pass reads.
void read_surfaces(PassDeclaration& declaration);

/// Whether reservoirs of the previous frame still hold for their receivers: the scene rests, and so do the widths of
/// the ray cones that select levels of textures at the receivers. The camera may move.
bool reservoirs_hold(const FrameContext& frame);

/// The history in this frame. `cap`: largest confidence, in frames. There is none where a pilot ends: the samples that
/// chose the probabilities of adaptive sampling must not return to the image.
template <typename Sample>
ReservoirHistory<Sample> reservoir_history(const FrameContext& frame, const ReuseBuffers<Sample>& buffers, int cap) {
  return {.reprojection = backward_reprojection(frame, kSurface),
          .reservoirs = frame.previous(buffers.history),
          .records = frame.previous(buffers.receivers),
          .cap = frame.ends_pilot ? 0.0f : static_cast<float>(cap),
          .moved = includes(frame.changes, Change::geometry),
          .holds = reservoirs_hold(frame)};
}

/// The search for neighbours in this frame.
NeighbourSearch neighbour_search(const FrameContext& frame, int neighbours, float radius);

/// The pixels that have a path. The pass must read kAllocation if any.
SampledPixels sampled_pixels(const FrameContext& frame);

/// The planes to which reservoirs add light: the pass must write kRadiance and kRays, and kRadianceSpecular if any, and
/// read kAllocation if any.
ReuseImage reuse_image(const FrameContext& frame);

}  // namespace relume
