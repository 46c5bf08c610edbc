"""Meshes of Blender to occlod and back."""
import bpy
import numpy
import occlod

# Attributes that are carried, or made anew, under these names.
CARRIED = ("material_index", "sharp_face", "sharp_edge", "custom_normal")


def _values(collection, name, width=1, dtype=numpy.float32):
    """A property of all elements: (n, width), or (n,) where the width is 1."""
    values = numpy.empty(len(collection) * width, dtype)
    collection.foreach_get(name, values)
    return values if width == 1 else values.reshape(-1, width)


def _uv_of(data):
    """The UV map that is rendered, or None."""
    return next((layer for layer in data.uv_layers if layer.active_render), None)


def from_data(data):
    """A mesh with a vertex for each corner of the faces; clean() welds them. It has the UV map that is rendered, the active
    colours, the numbers of material slots, and normals where sharp edges make them differ at one vertex. Object space.
    Error without faces, and where a corner is not finite."""
    data.calc_loop_triangles()
    if not data.loop_triangles:
        raise occlod.Error(data.name, "", "has no faces", "choose a mesh with faces")
    vertices = _values(data.loops, "vertex_index", dtype=numpy.int32)
    places = _values(data.vertices, "co", 3)[vertices]
    if not (finite := numpy.isfinite(places).all(axis=1)).all():
        raise occlod.Error(data.name, f"vertex {vertices[finite.argmin()]}", "is NaN or infinite", "remove it with its faces")
    uv, color = _uv_of(data), data.color_attributes.active_color
    colors = None
    if color is not None:
        colors = numpy.rint(_values(color.data, "color_srgb", 4).clip(0, 1) * 255).astype(numpy.uint8)
        colors = colors[vertices] if color.domain == "POINT" else colors
    slots = _values(data.loop_triangles, "material_index", dtype=numpy.int32)
    return occlod.Mesh(
        places,
        _values(data.loop_triangles, "loops", 3, numpy.int32),
        normals=_values(data.corner_normals, "vector", 3) if data.normals_domain == "CORNER" else None,
        colors=colors,
        texture_coordinates=None if uv is None else _values(uv.uv, "vector", 2),
        triangle_materials=slots,
        materials=[occlod.Material(str(slot)) for slot in range(slots.max() + 1)])


def to_data(mesh, like):
    """A new mesh of Blender with the materials of `like`, and its UV map and colours by their names, where they were."""
    corners, count = mesh.wedge_triangles.reshape(-1), mesh.triangle_count
    data = bpy.data.meshes.new(like.name)
    for material in like.materials:
        data.materials.append(material)
    data.vertices.add(mesh.vertex_count)
    data.vertices.foreach_set("co", mesh.positions[: mesh.vertex_count].reshape(-1))
    data.loops.add(3 * count)
    data.loops.foreach_set("vertex_index", mesh.triangles.reshape(-1).astype(numpy.int32))
    data.polygons.add(count)
    data.polygons.foreach_set("loop_start", numpy.arange(0, 3 * count, 3, dtype=numpy.int32))
    data.polygons.foreach_set("use_smooth", numpy.full(count, like.normals_domain != "FACE"))
    if mesh.triangle_materials is not None:
        data.polygons.foreach_set("material_index", mesh.triangle_materials.astype(numpy.int32))
    if mesh.texture_coordinates is not None:
        layer = data.uv_layers.new(name=_uv_of(like).name, do_init=False)
        layer.uv.foreach_set("vector", mesh.texture_coordinates[corners].reshape(-1))
    if mesh.colors is not None:
        _set_colors(data, mesh, like.color_attributes.active_color)
    data.update(calc_edges=True)
    if mesh.normals is not None:
        data.normals_split_custom_set(mesh.normals[corners])
    data.validate(clean_customdata=False)  # takes away faces that lie there twice, which Blender has not
    return data


def _set_colors(data, mesh, like):
    """By vertex if `like` has them so and each vertex has one colour, else by corner."""
    first = mesh.colors[: mesh.vertex_count]
    by_vertex = like.domain == "POINT" and (mesh.colors[mesh.vertex_count :] == first[mesh.extra_wedges]).all()
    colors = first if by_vertex else mesh.colors[mesh.wedge_triangles.reshape(-1)]
    layer = data.color_attributes.new(like.name, like.data_type, "POINT" if by_vertex else "CORNER")
    layer.data.foreach_set("color_srgb", (colors / numpy.float32(255)).reshape(-1))


def left_out(object):
    """What the mesh of an object has that from_data() and to_data() do not carry, in words."""
    data = object.data
    layers = (_uv_of(data), data.color_attributes.active_color)
    carried = {*CARRIED, *(layer.name for layer in layers if layer is not None)}
    lost = [f'attribute "{a.name}"' for a in data.attributes if not (a.is_internal or a.is_required or a.name in carried)]
    lost += [f'vertex group "{group.name}"' for group in object.vertex_groups]
    lost += ["shape keys"] if data.shape_keys else []
    lost += ["sculpted details"] if any(modifier.type == "MULTIRES" for modifier in object.modifiers) else []
    loose = int(_values(data.edges, "is_loose", dtype=bool).sum())
    return lost + ([f"loose edges ({loose})"] if loose else [])
