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
  /// Adds the pass after the others of its stage.
  void add(std::unique_ptr<Pass> pass);

  /// Checks that every buffer has one owner and exists where it is read. A buffer must be written by an earlier pass of
  /// the frame unless it is persistent, double-buffered or owned by the reader. Throws std::logic_error with pass and
  /// buffer: an error in the list of passes, not in user input.
  void check() const;

  /// Adds the buffers that the passes own.
  void add_buffers(BufferTable& table) const;

  /// Runs one frame, and calls `after_pass` (if not empty) with the name of each pass after the pass has run. Returns
  /// false if a stop was requested first. Passes have then undone their changes outside buffers, as after an exception.
  /// Throws std::logic_error where a pass accesses a buffer that it has not declared.
  bool run(const FrameContext& frame, const std::function<void(const std::string&)>& after_pass = {});

  /// Undoes a frame that run() completed, except for passes with Pass::commits(), which cannot undo their changes. If
  /// there may be any, the caller must end all histories: the next frame's `changes` must contain Change::settings.
  /// If a pass throws, the others are undone nonetheless, and the first exception is thrown.
  void abandon() { abandon(passes_.size() - 1); }

  /// Shortest epoch of the learning passes; 0: none learns.
  uint32_t longest_epoch() const;
  /// Whether a frame can be stopped after a pass has changed persistent buffers.
  bool stops_late() const;
  bool keeps_to_pixels() const;
  /// Maximum of Pass::correlated_frames() over all passes.
  uint32_t correlated_frames() const;
  bool prepared() const;
  size_t memory_bytes() const;
  std::vector<PassDeclaration> declarations() const;
  /// Statistics of all passes, with the pass's name as a prefix: "cells.occupancy".
  std::vector<PassStatistic> statistics() const;
  /// Tables of all passes, with the pass's name as a prefix: "octree.leaves".
  std::vector<PassRecords> records() const;
  std::vector<std::string> warnings() const;

  void save(std::ostream& out) const;
  void load(std::istream& in);

 private:
  bool run_pass(size_t i, FrameContext& frame);
  void abandon(size_t last);  ///< calls Pass::abandon() of pass `last` and the earlier ones

  std::vector<std::unique_ptr<Pass>> passes_;
  std::vector<std::unique_ptr<BufferAccess>> access_;  ///< one per pass
};

}  // namespace relume
