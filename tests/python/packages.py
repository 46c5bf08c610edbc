"""Packages that tests use beside NumPy. None where one is not installed: what needs it is skipped."""
try:
    import trimesh
except ImportError:
    trimesh = None
try:
    import pyvista
except ImportError:
    pyvista = None
try:
    import open3d
except (ImportError, OSError):
    open3d = None
try:
    import nbclient
    import nbformat
except ImportError:
    nbclient = nbformat = None
try:
    import tqdm
except ImportError:
    tqdm = None
try:
    import bpy
    import bpy_extras.object_utils
    import mathutils
except ImportError:
    bpy = bpy_extras = mathutils = None
