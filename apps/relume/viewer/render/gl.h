// OpenGL 3.3 core, called directly: the library exports it on every supported system.
#pragma once

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>
