#pragma once
// Eigen first: ff++.hpp redefines assert.
#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "ff++.hpp"
#include "strversionnumber.hpp"
