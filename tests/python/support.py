"""Meshes and views of the tests."""
import numpy

import occlod

VIEW = occlod.Camera(eye=(0, 0, 3))


def tetrahedron():
    """Closed, 4 triangles, outsides counter-clockwise."""
    positions = numpy.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], numpy.float32)
    triangles = numpy.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], numpy.uint32)
    return positions, triangles


def planet(level=4):
    """A mesh of 8 * 4**level triangles, and its hierarchy."""
    mesh = occlod.generate_rough_planet(level=level)
    return mesh, occlod.build_hierarchy(mesh)


def corners(positions, triangles):
    """Triangles by their positions, each turned so that its smallest corner comes first, sorted: the same iff the same mesh."""
    turned = []
    for triangle in numpy.asarray(positions)[numpy.asarray(triangles)].tolist():
        first = triangle.index(min(triangle))
        turned.append(tuple(map(tuple, triangle[first:] + triangle[:first])))
    return sorted(turned)
