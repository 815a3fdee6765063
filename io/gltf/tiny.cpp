// The only unit with the implementation of tinygltf, which takes long to compile.

#define TINYGLTF_IMPLEMENTATION
#include <fstream>

#include "io/gltf/tiny_model.h"
