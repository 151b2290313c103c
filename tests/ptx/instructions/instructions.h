// PTX's instructions as C++ functions, named after them. The translator's table (translator/forms.py) says which
// instruction calls which.
#pragma once

#include "instructions/comparison.h"
#include "instructions/conversion.h"
#include "instructions/integer.h"
#include "instructions/logic.h"
#include "instructions/memory.h"
#include "instructions/real.h"
#include "instructions/thread.h"
