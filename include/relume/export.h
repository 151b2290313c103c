// Marks what the shared library exports; everything else stays hidden.
#pragma once

#if defined(__GNUC__) || defined(__clang__)
#define RELUME_API __attribute__((visibility("default")))
#else
#define RELUME_API
#endif
