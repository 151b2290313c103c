// The complete public interface of relume.
#pragma once

#include "relume/aov.h"
#include "relume/buffers.h"
#include "relume/builtin_scenes.h"
#include "relume/error.h"
#include "relume/image.h"
#include "relume/image_io.h"
#include "relume/math.h"
#include "relume/records.h"
#include "relume/render.h"
#include "relume/scene.h"
#include "relume/scene_io.h"
#include "relume/session.h"
#include "relume/settings.h"
#include "relume/statistics.h"
#include "relume/tone_map.h"
#include "relume/version.h"
