#include "navmesh/build/navmesh.h"
