// What nearly every file of the core reads: the Makefile compiles it once. No file includes it.
#include <Eigen/Geometry>

#include "types.h"
