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
    mesh = occlod.generate("rough-planet", level=level)
    return mesh, occlod.build_hierarchy(mesh)


def corners(positions, triangles):
    """Triangles by their positions, each turned so that its smallest corner comes first, sorted: the same iff the same mesh."""
    turned = []
    for triangle in numpy.asarray(positions)[numpy.asarray(triangles)].tolist():
        first = triangle.index(min(triangle))
        turned.append(tuple(map(tuple, triangle[first:] + triangle[:first])))
    return sorted(turned)


def box_of_charts(**more):
    """A cube of 2 * 8 * 8 triangles a side, whose sides have vertices, colours, squares of the texture and materials of their own."""
    steps = numpy.linspace(-1, 1, 9)
    positions, texture_coordinates, colors, triangles, materials = [], [], [], [], []
    for side in range(6):
        axis, sign = side // 2, 1 - 2 * (side % 2)
        first = len(positions)
        for b in steps:
            for a in steps:
                place = numpy.empty(3)
                place[[axis, (axis + 1) % 3, (axis + 2) % 3]] = sign, a * sign, b
                positions.append(place)
                texture_coordinates.append(((a + 1) / 2 + 2 * side, (b + 1) / 2))
                colors.append((40 * side, 255 - 40 * side, 100, 255))
        for j in range(8):
            for i in range(8):
                corner = first + 9 * j + i
                triangles += [(corner, corner + 1, corner + 10), (corner, corner + 10, corner + 9)]
                materials += [side % 2] * 2
    return occlod.Mesh(
        numpy.array(positions), numpy.array(triangles), colors=numpy.array(colors, numpy.uint8), texture_coordinates=numpy.array(texture_coordinates),
        triangle_materials=numpy.array(materials),
        materials=[occlod.Material("even", base_color=(1, 0.5, 0.25, 1), texture=0), occlod.Material("odd")],
        textures=[occlod.Texture("checker.png", wrap_s=occlod.TextureWrap.clamp)], **more)


def looks(mesh):
    """What corners() is, with texture coordinate, colour and material of each corner."""
    material = mesh.triangle_materials if mesh.triangle_materials is not None else numpy.zeros(mesh.triangle_count, int)
    result = []
    for triangle, of_triangle in zip(mesh.wedge_triangles, material.tolist()):
        there = [(*mesh.positions[w].tolist(), *mesh.texture_coordinates[w].tolist(), *mesh.colors[w].tolist(), of_triangle) for w in triangle]
        first = there.index(min(there))
        result.append(tuple(there[first:] + there[:first]))
    return sorted(result)
