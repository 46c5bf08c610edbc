// tinygltf under another namespace: a program that compiles its own copy of it, of any version, links this library too.
#pragma once

#define tinygltf occlod_tinygltf    // NOLINT(readability-identifier-naming): the name of its namespace
#define TINYGLTF_NO_INCLUDE_JSON    // which lies in different places
#define TINYGLTF_NO_STB_IMAGE       // textures are not decoded
#define TINYGLTF_NO_EXTERNAL_IMAGE  // nor looked for
#define TINYGLTF_NO_STB_IMAGE_WRITE
#include <nlohmann/json.hpp>
// After the JSON parser that it uses.
#include <tiny_gltf.h>
