// Includes tinygltf under another namespace, so that a program with its own copy of it, of any version, can link this
// library.
#pragma once

#define tinygltf occlod_tinygltf    // NOLINT(readability-identifier-naming): the name of its namespace
#define TINYGLTF_NO_INCLUDE_JSON    // its place differs between systems
#define TINYGLTF_NO_STB_IMAGE       // textures are not decoded
#define TINYGLTF_NO_EXTERNAL_IMAGE  // and not looked for
#define TINYGLTF_NO_STB_IMAGE_WRITE
#include <nlohmann/json.hpp>
// tiny_gltf.h must come after the JSON parser that it uses.
#include <tiny_gltf.h>
