// Controls the stub driver, from the program that has loaded it.
#pragma once

#include <cstddef>

extern "C" {

/// Replaces all settings, and clears counts. `text`: words such as "devices=2", separated by spaces (README.md lists
/// them); other settings have their defaults. Aborts on unknown words.
void relume_stub_configure(const char* text);

/// Objects of a kind that exist: "contexts", "modules", "streams", "events", "graphs" (captured or to be launched),
/// "textures" that are registered, "managed" (all of the device's memory) and "locked" blocks. Of two kinds, those
/// since the last relume_stub_configure(): "leaked" objects existed when the last context ended without an error, and
/// blocks were "moved to N", a device.
size_t relume_stub_objects(const char* kind);

/// Makes a texture of OpenGL, which the driver can then register. `rows` 0: removes it.
void relume_stub_make_texture(unsigned name, size_t row_bytes, size_t rows);

/// The content of that texture, as OpenGL would draw it now.
const void* relume_stub_texture(unsigned name);

/// Calls of a function of the driver since the last relume_stub_configure(), with the name in the library.
size_t relume_stub_calls(const char* function);
}
