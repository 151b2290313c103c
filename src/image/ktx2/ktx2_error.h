// Errors of KTX2 files.
#pragma once

#include <string>

namespace relume::detail {

/// Throws Error: the file is inconsistent or violates its format. `problem` completes "damaged image (…)".
[[noreturn]] void fail_damaged_ktx2(const std::string& name, const std::string& problem);

/// Throws Error: the file ends before its data.
[[noreturn]] void fail_cut_off_ktx2(const std::string& name);

/// Throws Error: the file is valid, but `feature` is not supported. It completes "KTX2 images with …".
[[noreturn]] void fail_unsupported_ktx2(const std::string& name, const std::string& feature);

}  // namespace relume::detail
