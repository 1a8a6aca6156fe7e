// What every file that sees FreeFEM reads: the Makefile compiles it once. No file includes it.
#include "core/precompiled.h"
#include "freefem/freefem.h"
