// The complete public interface of relume::lab.
#pragma once

#include "relume/lab/compare.h"
#include "relume/lab/experiments.h"
#include "relume/lab/flip.h"
#include "relume/lab/metrics.h"
