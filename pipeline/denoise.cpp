#include "rfsmooth/pipeline/denoise.h"
