#include "burnish/precompute/ray_scene.h"
