#include "navmesh/nav_graph.h"
