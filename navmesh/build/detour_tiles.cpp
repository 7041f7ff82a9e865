#include "navmesh/build/detour_tiles.h"
