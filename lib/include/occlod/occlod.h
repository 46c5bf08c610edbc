// What a first program needs: from a mesh to its hierarchy, and from there to the triangles of a view. Pictures,
// scenes, comparisons and the OpenGL backends have headers of their own.
#pragma once

#include "occlod/auto_refiner.h"
#include "occlod/base.h"
#include "occlod/build_hierarchy.h"
#include "occlod/generate.h"
#include "occlod/mesh_file.h"
#include "occlod/refiner.h"
#include "occlod/simplify.h"
#include "occlod/view.h"
#include "occlod/visibility.h"
