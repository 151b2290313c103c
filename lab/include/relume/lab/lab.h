// The public interface of relume::lab, all of it.
#pragma once

#include "relume/lab/compare.h"
#include "relume/lab/experiments.h"
#include "relume/lab/flip.h"
#include "relume/lab/metrics.h"
