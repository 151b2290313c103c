// The passes of a frame, in order.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "frame/pass.h"

namespace relume {

class Pipeline {
 public:
  /// Puts the pass after the others of its stage.
  void add(std::unique_ptr<Pass> pass);

  /// Checks that every buffer has one owner, that it exists where it is read, and that it is written by an earlier pass
  /// of the frame unless it is persistent, double-buffered or belongs to the reader. Throws std::logic_error naming
  /// pass and buffer: a mistake in the list of passes, not of a user.
  void check() const;

  /// Adds the buffers that the passes own.
  void add_buffers(BufferTable& table) const;

  /// Runs one frame, and calls `after_pass`, unless it is empty, with the name of each pass after it has run. False if
  /// a stop was requested first. Passes have then undone their changes, except those of buffers; so they have when an
  /// exception leaves a pass. Throws std::logic_error where a pass accesses a buffer that it does not declare.
  bool run(const FrameContext& frame, const std::function<void(const std::string&)>& after_pass = {});

  /// The shortest of the passes that learn; 0: none does.
  uint32_t longest_epoch() const;
  /// Whether a frame can be stopped after a pass has changed persistent buffers.
  bool stops_late() const;
  bool keeps_to_pixels() const;
  bool prepared() const;
  size_t memory_bytes() const;
  std::vector<PassDeclaration> declarations() const;
  /// Of all passes; names begin with the pass's: "cells.occupancy".
  std::vector<PassStatistic> statistics() const;
  std::vector<std::string> warnings() const;

  void save(std::ostream& out) const;
  void load(std::istream& in);

 private:
  bool run_pass(size_t i, FrameContext& frame);
  void abandon(size_t last);  ///< pass `last` and those before it

  std::vector<std::unique_ptr<Pass>> passes_;
  std::vector<std::unique_ptr<BufferAccess>> access_;  ///< of each pass
};

}  // namespace relume
