"""libigl behind a pipe: a JSON line and raw little-endian arrays each way.

A request is {"vertices": n, "faces": m, "points": k, "call": c}, followed by n x 3 float64, m x 3 int64 and k x 3 float64;
"points" may be absent. The answer is a JSON line of facts that
ends with {"arrays": [[name, dtype, shape], ...]}, followed by those arrays.
"""

import json
import sys

import igl
import numpy as np

WEIGHTS = {
    "area": igl.PER_VERTEX_NORMALS_WEIGHTING_TYPE_AREA,
    "angle": igl.PER_VERTEX_NORMALS_WEIGHTING_TYPE_ANGLE,
}


def number(x):
    """A number for JSON, which knows no NaN."""
    return float(x) if np.isfinite(x) else None


def answer(v, f, points):
    """Everything the tests ask libigl about a triangle mesh. Indices must be in range: libigl does not look."""
    edges = igl.boundary_facets(f)[0]
    manifold = igl.is_edge_manifold(f)
    count, components = igl.facet_components(f)
    oriented, patches = igl.bfs_orient(f)
    facts = {
        "edge_manifold": bool(manifold[0]),
        "components": int(count),
        "euler": int(igl.euler_characteristic(f)),
        "area": number(igl.doublearea(v, f).sum() / 2),
        "volume": number(igl.centroid(v, f)[1]),
        "centroid": [number(x) for x in igl.centroid(v, f)[0]],
    }
    arrays = {
        "boundary": np.asarray(edges, dtype="<i8").reshape(-1, 2),
        "vertex_manifold": np.asarray(igl.is_vertex_manifold(f), dtype="u1"),
        "face_component": np.asarray(components, dtype="<i8"),
        "oriented": np.asarray(oriented, dtype="<i8").reshape(-1, 3),
        "patch": np.asarray(patches, dtype="<i8"),
    }
    for name, weight in WEIGHTS.items():
        arrays["normals_" + name] = np.asarray(igl.per_vertex_normals(v, f, weight), dtype="<f8")
    if len(points):
        squares, _, nearest = igl.point_mesh_squared_distance(points, v, f)
        arrays["point_square"] = np.asarray(squares, dtype="<f8")
        arrays["point_nearest"] = np.asarray(nearest, dtype="<f8").reshape(-1, 3)
        arrays["point_winding"] = np.asarray(igl.winding_number(v, f, points), dtype="<f8")
        arrays["inertia"] = np.asarray(igl.moments(v, f)[2], dtype="<f8")
    return facts, arrays


def mesh(v, f):
    """A mesh as the answer."""
    return {}, {
        "vertices": np.asarray(v, dtype="<f8").reshape(-1, 3),
        "faces": np.asarray(f, dtype="<i8").reshape(-1, 3),
    }


def laplacian(v, f, _):
    """What the cotangent matrix makes of the positions, and its diagonal."""
    matrix = igl.cotmatrix(v, f)
    return {}, {
        "laplacian": np.asarray(matrix @ v, dtype="<f8").reshape(-1, 3),
        "diagonal": np.asarray(matrix.diagonal(), dtype="<f8"),
    }


CALLS = {
    "facts": answer,
    "loop1": lambda v, f, _: mesh(*igl.loop(v, f, 1)),
    "loop2": lambda v, f, _: mesh(*igl.loop(v, f, 2)),
    "upsample1": lambda v, f, _: mesh(*igl.upsample(v, f, 1)),
    "upsample2": lambda v, f, _: mesh(*igl.upsample(v, f, 2)),
    "cotmatrix": laplacian,
}


def read(stream, dtype, rows):
    """A table of three columns from the pipe."""
    data = stream.read(rows * 3 * np.dtype(dtype).itemsize)
    return np.frombuffer(data, dtype=dtype).reshape(rows, 3).copy(order="C")


def main():
    """Answers until the pipe closes."""
    source, sink = sys.stdin.buffer, sys.stdout.buffer
    for line in source:
        request = json.loads(line)
        v = read(source, "<f8", request["vertices"])
        f = read(source, "<i8", request["faces"])
        points = read(source, "<f8", request.get("points", 0))
        if len(f) == 0 or f.min() < 0 or f.max() >= len(v):
            facts, arrays = {"error": "no faces, or indices out of range"}, {}
        else:
            call, _, faces = request["call"].partition(":")
            if call == "qslim":
                facts, arrays = mesh(*igl.qslim(v, f, max_m=int(faces))[:2])
            else:
                facts, arrays = CALLS[call](v, f, points)
        facts["arrays"] = [[name, a.dtype.str, list(a.shape)] for name, a in arrays.items()]
        sink.write(json.dumps(facts).encode() + b"\n")
        for array in arrays.values():
            sink.write(np.ascontiguousarray(array).tobytes())
        sink.flush()


main()
