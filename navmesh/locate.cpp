#include "navmesh/locate.h"
