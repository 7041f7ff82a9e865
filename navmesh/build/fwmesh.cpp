#include "navmesh/build/fwmesh.h"
