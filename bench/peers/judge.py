"""Measures a reduced mesh against its input without any code of occlod: distances, normals and colours by Open3D's ray tracer (Embree), topology by
counting edges."""
import numpy
import open3d

SAMPLES = 200_000
PERIODS = 8  # of the texture that colours come from, along each axis


class Surface:
    """A mesh with its closest points. Positions are relative to the input's box, and its diagonal is 1."""

    def __init__(self, positions, triangles, texture=None):
        self.positions, self.triangles, self.texture = positions.astype(numpy.float32), triangles.astype(numpy.int64), texture
        self.scene = open3d.t.geometry.RaycastingScene(nthreads=1)
        self.scene.add_triangles(open3d.core.Tensor(self.positions), open3d.core.Tensor(triangles.astype(numpy.uint32)))
        a, b, c = (positions[triangles[:, i]].astype(numpy.float64) for i in range(3))
        cross = numpy.cross(b - a, c - a)
        self.areas = numpy.linalg.norm(cross, axis=1)
        self.normals = cross / numpy.maximum(self.areas, 1e-30)[:, None]

    def samples(self):
        """Triangles and weights of their corners, spread evenly over the area."""
        random = numpy.random.default_rng(1)
        chosen = random.choice(len(self.triangles), SAMPLES, p=self.areas / self.areas.sum())
        root, second = numpy.sqrt(random.random(SAMPLES)), random.random(SAMPLES)
        return chosen, numpy.column_stack((1 - root, root * (1 - second), root * second))

    def at(self, values, chosen, weights):
        return numpy.einsum("ij,ijk->ik", weights, values[self.triangles[chosen]].astype(numpy.float64))

    def color(self, chosen, weights):
        u, v = (2 * numpy.pi * PERIODS * self.at(self.texture, chosen, weights)).T
        return 0.5 + 0.5 * numpy.sin(u) * numpy.sin(v)

    def closest(self, points):
        found = self.scene.compute_closest_points(open3d.core.Tensor(points.astype(numpy.float32)), nthreads=1)
        u, v = found["primitive_uvs"].numpy().astype(numpy.float64).T
        distances = numpy.linalg.norm(points - found["points"].numpy(), axis=1)
        return distances, found["primitive_ids"].numpy(), numpy.column_stack((1 - u - v, u, v))


def one_way(a, b):
    """Root mean square and maximum distance from `a` to `b`, angle between the normals, share of normals turned over."""
    chosen, weights = a.samples()
    distances, ids, _ = b.closest(a.at(a.positions, chosen, weights))
    at_vertices, _, _ = b.closest(a.positions[numpy.unique(a.triangles)].astype(numpy.float64))
    cosines = numpy.clip((a.normals[chosen] * b.normals[ids]).sum(axis=1), -1, 1)
    angle = numpy.degrees(numpy.sqrt((numpy.arccos(cosines) ** 2).mean()))
    return numpy.sqrt((distances**2).mean()), max(distances.max(), at_vertices.max()), angle, (cosines < 0).mean()


def color_error(a, b):
    """Of a texture of waves: root mean square of the difference between what a point of `a` shows and what the nearest of `b` does."""
    chosen, weights = a.samples()
    _, ids, there = b.closest(a.at(a.positions, chosen, weights))
    return numpy.sqrt(((a.color(chosen, weights) - b.color(ids, there)) ** 2).mean())


def topology(positions, triangles):
    """Counts of the mesh welded by equal positions, without triangles that have a corner twice."""
    _, same = numpy.unique(positions, axis=0, return_inverse=True)
    welded = same.reshape(-1)[triangles]
    is_whole = (welded != numpy.roll(welded, 1, axis=1)).all(axis=1)
    welded = welded[is_whole]
    edges = numpy.sort(numpy.concatenate([welded[:, [0, 1]], welded[:, [1, 2]], welded[:, [2, 0]]]), axis=1)
    _, uses = numpy.unique(edges, axis=0, return_counts=True)
    legacy = open3d.geometry.TriangleMesh(
        open3d.utility.Vector3dVector(numpy.zeros((same.max() + 1, 3))), open3d.utility.Vector3iVector(welded.astype(numpy.int32)))
    return {
        "components": len(legacy.cluster_connected_triangles()[1]),
        "boundary_edges": int((uses == 1).sum()),
        "nonmanifold_edges": int((uses > 2).sum()),
        "collapsed_triangles": int((~is_whole).sum()),
    }


class Judge:
    def __init__(self, positions, triangles, texture):
        low, high = positions.min(axis=0).astype(numpy.float64), positions.max(axis=0).astype(numpy.float64)
        self.middle, self.diagonal = (low + high) / 2, numpy.linalg.norm(high - low)
        self.topology = topology(positions, triangles)
        self.input = self.surface(positions, triangles, texture)

    def surface(self, positions, triangles, texture):
        return Surface((positions.astype(numpy.float64) - self.middle) / self.diagonal, triangles, texture)

    def measure(self, positions, triangles, texture):
        reduced = self.surface(positions, triangles, texture)
        there, back = one_way(self.input, reduced), one_way(reduced, self.input)
        scores = {
            "open3d_rms_pct": 100 * max(there[0], back[0]),
            "open3d_max_pct": 100 * max(there[1], back[1]),
            "normals_deg": max(there[2], back[2]),
            "turned_pct": 100 * back[3],
        }
        if texture is not None and self.input.texture is not None:
            scores["color_error_pct"] = 100 * color_error(self.input, reduced)
        return scores | topology(positions, triangles)
