#include "rfsmooth/smoothing/flow.h"
