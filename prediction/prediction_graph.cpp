#include "prediction/prediction_graph.h"
