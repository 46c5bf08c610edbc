#define TINYGLTF_IMPLEMENTATION
#include "mesh/tinygltf.h"
