#pragma once
// Eigen first: ff++.hpp redefines assert.
#include "../core/types.h"

#include "ff++.hpp"
#include "strversionnumber.hpp"
