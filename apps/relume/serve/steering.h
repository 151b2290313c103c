// Which of several viewers steers.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace relume::serve {

/// Numbers of viewers count up from 1; 0 is none. The first viewer steers until it leaves, grants, or is inactive for
/// kInactive_s while another requests.
class Steering {
 public:
  static constexpr double kInactive_s = 20;

  void join(uint32_t viewer, double now_s);
  void leave(uint32_t viewer, double now_s);
  /// A viewer asks to steer. It does at once if the present one is inactive.
  void request(uint32_t viewer, double now_s);
  /// The steering viewer hands over; calls of others, and unknown viewers, have no effect.
  void grant(uint32_t from, uint32_t to, double now_s);
  /// Records input of the steering viewer.
  void active(uint32_t viewer, double now_s);
  /// Hands over to the first that requests if the present one is inactive.
  void update(double now_s);

  bool steers(uint32_t viewer) const { return viewer != 0 && viewer == steerer_; }
  uint32_t steerer() const { return steerer_; }
  const std::vector<uint32_t>& viewers() const { return viewers_; }
  const std::vector<uint32_t>& requests() const { return requests_; }

 private:
  void hand_to(uint32_t viewer, double now_s);

  std::vector<uint32_t> viewers_;   ///< by arrival
  std::vector<uint32_t> requests_;  ///< by arrival
  uint32_t steerer_ = 0;
  double active_s_ = 0;
};

}  // namespace relume::serve
