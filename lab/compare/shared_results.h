// Results of a comparison as bytes, for ranks of the same version on processors of the same byte order.
#pragma once

#include <string>
#include <vector>

#include "compare/comparison.h"

namespace relume {

/// One repetition of one or more contenders.
struct RunResult {
  int threads = 0;
  std::vector<Repetition> repetitions;  ///< by contender
  std::vector<Image> images;            ///< of the last frame, by contender
};

std::string to_bytes(const RunResult& result);
std::string to_bytes(const ReferenceHalf& half);
std::string to_bytes(const std::vector<Reference>& references);
std::string to_bytes(const EqualTime& equal);
std::string to_bytes(const std::vector<std::string>& texts);

// All throw Error if the bytes end early.
RunResult run_result_from(const std::string& bytes);
ReferenceHalf reference_half_from(const std::string& bytes);
std::vector<Reference> references_from(const std::string& bytes);
EqualTime equal_time_from(const std::string& bytes);
std::vector<std::string> texts_from(const std::string& bytes);

}  // namespace relume
