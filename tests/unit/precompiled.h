// What nearly every unit test reads: the Makefile compiles it once. No file includes it.
#include <gtest/gtest.h>

#include "core/precompiled.h"
