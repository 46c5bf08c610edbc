"""Simplifies the active mesh, or refines it for what the scene's camera sees of it, by occlod."""
import bpy
import numpy
import occlod

from . import meshes


def _view_of(context):
    """What the scene's camera sees in its rendered image."""
    scene, render = context.scene, context.scene.render
    if scene.camera is None or scene.camera.type != "CAMERA":
        raise occlod.Error(scene.name, "", "has no active camera", "add one")
    if scene.camera.data.type == "PANO":
        raise occlod.Error(scene.camera.name, "", "is panoramic", "choose a perspective or orthographic camera")
    if render.pixel_aspect_x != render.pixel_aspect_y:
        raise occlod.Error(scene.name, "", "renders pixels that are not square", "set both aspects to 1")
    width, height = (size * render.resolution_percentage // 100 for size in (render.resolution_x, render.resolution_y))
    depsgraph = context.evaluated_depsgraph_get()
    camera = scene.camera.evaluated_get(depsgraph)
    projection = camera.calc_matrix_camera(depsgraph, x=width, y=height)
    to_eye = camera.matrix_world.normalized().inverted()
    return occlod.view_of(numpy.array(to_eye), numpy.array(projection), width, height)


def _to_world(context):
    """The active object's place, (4, 4), also where it has just been moved."""
    return numpy.array(context.active_object.evaluated_get(context.evaluated_depsgraph_get()).matrix_world)


class _Reduces:
    """An operator that gives the active object another mesh. Other objects that shared it keep the old one."""

    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        active = context.active_object
        if active is None or active.type != "MESH" or active.mode != "OBJECT" or not active.is_editable:
            cls.poll_message_set("choose a mesh object that is not linked, in Object Mode")
            return False
        return True

    def invoke(self, context, _event):
        return context.window_manager.invoke_props_dialog(self)

    def execute(self, context):
        active, window = context.active_object, context.window_manager
        window.progress_begin(0, 1)
        try:
            mesh, _ = meshes.from_data(active.data).clean()
            reduced = self.reduced(context, mesh, window.progress_update)
        except (occlod.Error, ValueError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        finally:
            window.progress_end()
        if lost := meshes.left_out(active):
            self.report({"WARNING"}, f"{active.name}: leaves out {', '.join(lost)}")
        active.data = meshes.to_data(reduced, active.data)
        self.report({"INFO"}, f"{active.name}: {len(active.data.polygons):,} of {mesh.triangle_count:,} triangles")
        return {"FINISHED"}


class OBJECT_OT_occlod_simplify(_Reduces, bpy.types.Operator):
    """Reduce the mesh to fewer triangles, the same for every view"""

    bl_idname = "object.occlod_simplify"
    bl_label = "Simplify"

    goal: bpy.props.EnumProperty(name="To", items=[
        ("ratio", "Ratio", "A share of the triangles"),
        ("triangles", "Triangles", "A number of triangles"),
        ("error", "Error", "The fewest triangles within a distance of the mesh. Takes long")])
    ratio: bpy.props.FloatProperty(name="Ratio", description="Of the triangles", default=0.1, min=0, max=1)
    triangles: bpy.props.IntProperty(name="Triangles", description="At most so many", default=10_000, min=0)
    error: bpy.props.FloatProperty(
        name="Error", description="Distance from the mesh, measured where the object stands", default=0.01, min=0,
        precision=4, subtype="DISTANCE")

    def draw(self, _context):
        self.layout.row().prop(self, "goal", expand=True)
        self.layout.prop(self, self.goal)

    def reduced(self, context, mesh, progress):
        value = getattr(self, self.goal)
        if self.goal == "error":  # object units
            value /= numpy.linalg.norm(_to_world(context)[:3, :3], ord=2) or 1
        return occlod.simplify(mesh, **{self.goal: value}, progress=progress)


class OBJECT_OT_occlod_refine(_Reduces, bpy.types.Operator):
    """Keep triangles where the scene's camera sees them in its rendered image, and few where it does not"""

    bl_idname = "object.occlod_refine"
    bl_label = "Refine for This Camera"

    budget: bpy.props.IntProperty(name="Triangles", description="At most so many", default=10_000, min=0)

    def reduced(self, context, mesh, progress):
        view = _view_of(context)
        hierarchy = occlod.build_hierarchy(mesh, progress=progress)
        # Blender renders both sides; those that the mesh itself hides are found as hidden.
        placed = occlod.Object(hierarchy, _to_world(context), two_sided=True)
        return occlod.Refiner([placed]).refine(view, self.budget).mesh()


class VIEW3D_PT_occlod(bpy.types.Panel):
    bl_label = bl_category = "occlod"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"

    def draw(self, _context):
        self.layout.operator(OBJECT_OT_occlod_simplify.bl_idname)
        self.layout.operator(OBJECT_OT_occlod_refine.bl_idname)


register, unregister = bpy.utils.register_classes_factory(
    (OBJECT_OT_occlod_simplify, OBJECT_OT_occlod_refine, VIEW3D_PT_occlod))
