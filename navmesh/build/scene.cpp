#include "navmesh/build/scene.h"
