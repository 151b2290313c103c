// What the model shows to viewers.
#pragma once

#include <memory>
#include <string>

namespace relume::serve {

struct ShownImage;

/// Subjects of JSON texts to viewers. A newer text of a topic replaces an older one. Notices go to one viewer.
enum class Topic : int { role, declarations, values, status, notice };
inline constexpr int kTopics = 5;

/// Called on the model's thread; never waits for viewers.
class Publisher {
 public:
  virtual ~Publisher() = default;
  virtual void show(std::shared_ptr<const ShownImage> image) = 0;
  virtual void tell(Topic topic, std::string text) = 0;
};

}  // namespace relume::serve
