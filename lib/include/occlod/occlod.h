// What a first program needs: from a mesh to its hierarchy, and from there to the triangles of a view. Pictures,
// scenes, comparisons and the OpenGL backends have headers of their own.
#pragma once

#include "occlod/core/error.h"
#include "occlod/core/version.h"
#include "occlod/effects/auto_refiner.h"
#include "occlod/hierarchy/build.h"
#include "occlod/io/olod.h"
#include "occlod/io/read_mesh.h"
#include "occlod/mesh/generate.h"
#include "occlod/occlusion/software_occlusion.h"
#include "occlod/refine/refiner.h"
#include "occlod/view/view.h"
