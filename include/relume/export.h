// Marks symbols that the shared library exports; all others are hidden.
#pragma once

#if defined(__GNUC__) || defined(__clang__)
#define RELUME_API __attribute__((visibility("default")))
#else
#define RELUME_API
#endif
