// The PTX modules that the stub driver can load, translated to C++ when it was built.
#pragma once

#include <string>
#include <vector>

#include "runtime/module.h"

namespace stub {

/// All modules. A stub driver defines this (relume_add_stub_driver in CMakeLists.txt).
std::vector<const ptx::Module*> translated_modules();

/// The module that was translated from a PTX text: its entries are those of the text. nullptr if there is none; then
/// `message` says why, like a message of the driver's compiler.
const ptx::Module* find_module(const std::string& text, std::string& message);

}  // namespace stub
