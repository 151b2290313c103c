// Collects the warnings of a loader about ignored or repaired input.
#pragma once

#include <string>
#include <unordered_set>
#include <utility>
#include <vector>

namespace relume {

/// Sentences for Scene::warnings. Repeated sentences are stored once, and only the first kMaxWarnings are kept, which
/// keeps the list readable.
class Warnings {
 public:
  static constexpr size_t kMaxWarnings = 100;

  explicit Warnings(std::string place) : place_(std::move(place)) {}

  void add(const std::string& sentence) {
    if (sentences_.size() >= kMaxWarnings) {
      ++omitted_;
    } else if (seen_.insert(sentence).second) {
      sentences_.push_back(sentence);
    }
  }

  /// Adds a sentence to Scene::notes: ignored input that does not change the image, or that path tracing computes.
  void note(const std::string& sentence) {
    if (notes_.size() < kMaxWarnings && seen_.insert(sentence).second) notes_.push_back(sentence);
  }

  /// Adds warnings collected in a separate task.
  void add(const Warnings& part) {
    for (const std::string& sentence : part.sentences_) add(sentence);
    for (const std::string& sentence : part.notes_) note(sentence);
    omitted_ += part.omitted_;
  }

  std::vector<std::string> take() {
    if (omitted_ > 0) sentences_.push_back(std::to_string(omitted_) + " more warnings are not shown");
    return named(std::move(sentences_));
  }

  std::vector<std::string> take_notes() { return named(std::move(notes_)); }

 private:
  std::vector<std::string> named(std::vector<std::string> sentences) const {
    for (std::string& sentence : sentences) sentence.insert(0, place_ + ": ");
    return sentences;
  }

  std::string place_;
  std::vector<std::string> sentences_;
  std::vector<std::string> notes_;
  std::unordered_set<std::string> seen_;
  size_t omitted_ = 0;
};

}  // namespace relume
