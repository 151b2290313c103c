// The quadtrees of all regions.
#pragma once

#include <iosfwd>

#include "core/array.h"
#include "core/stream_io.h"
#include "frame/launch.h"
#include "techniques/guiding/directional_quadtree/directional_quadtree.h"

namespace relume {

/// Whether the bits are a valid tree: the number of inner nodes matches that of groups, parents precede their children,
/// and no leaf is deeper than kMaxQuadtreeDepth. Traversals rely on nothing else.
bool is_quadtree(const DirectionalQuadtree& tree);

/// The quadtrees of all regions, by leaf slot, and the learned fractions of directions from the BSDF.
class Quadtrees {
 public:
  explicit Quadtrees(uint32_t bit_count, uint32_t regions = 0, Memory& memory = host_memory())
      : bit_count_(bit_count), words_(memory), fractions_(memory) {
    words_.reset(regions * (bit_count / 32));
  }

  QuadtreeArray view() { return {words_.mutable_view(), bit_count_}; }
  /// The trees for host code.
  QuadtreeArray write() { return {mutable_view_of(words_.write()), bit_count_}; }
  Memory& memory() const { return words_.memory(); }
  /// Allocates uninitialised trees, with uninitialised fractions if regions learn them.
  void reset(uint32_t bit_count, uint32_t regions, bool learns_fractions) {
    bit_count_ = bit_count;
    words_.reset(size_t{regions} * (bit_count / 32), kUninitialized);
    fractions_.reset(learns_fractions ? regions : 0, kUninitialized);
  }
  View<const float> fractions() const { return fractions_.view(); }
  View<float> mutable_fractions() { return fractions_.mutable_view(); }
  Quadtrees copy(Backend& backend) const;
  uint32_t size() const { return static_cast<uint32_t>(words_.size()) / (bit_count_ / 32); }
  uint32_t bit_count() const { return bit_count_; }
  size_t memory_bytes() const { return words_.memory_bytes() + fractions_.memory_bytes(); }
  /// Bytes of the trees, without spare memory.
  size_t data_bytes() const { return words_.size() * sizeof(words_.read()[0]); }
  void save(std::ostream& out) const {
    write_array(out, words_);
    write_array(out, fractions_);
  }
  /// Sets the stream's failbit and clears the trees unless all are quadtrees of bit_count() bits, and fractions are
  /// probabilities above zero.
  void load(std::istream& in);

 private:
  uint32_t bit_count_;
  Array<uint32_t> words_;
  Array<float> fractions_;  ///< by leaf slot, or empty
};

}  // namespace relume
