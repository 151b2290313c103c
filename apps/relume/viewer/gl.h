// OpenGL 3.3 core, straight from the library: every system that relume runs on exports it.
#pragma once

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>
