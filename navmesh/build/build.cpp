#include "navmesh/build/build.h"
