#include "navmesh/funnel.h"
