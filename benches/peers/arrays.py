"""Peers from PyPI on one shape, one line per operation as every program here prints them: libigl, fast-simplification,
MeshLib, Manifold.

Usage: arrays.py SHAPE.raw REPEATS [START]    (reduced meshes are left as START.NAME.ply)
"""

import sys
import time

import fast_simplification
import igl
import manifold3d
import meshlib.mrmeshnumpy as mrn
import meshlib.mrmeshpy as mr
import numpy as np


def read(path):
    raw = open(path, "rb").read()
    n, m = np.frombuffer(raw, "<u8", 2)
    v = np.frombuffer(raw, "<f8", 3 * n, 16).reshape(n, 3).copy()
    return v, np.frombuffer(raw, "<u4", 3 * m, 16 + 24 * n).reshape(m, 3).astype(np.int64)


def show(name, operation, value, unit):
    print(f"{name}\t{operation}\t{value:.3f}\t{unit}", flush=True)


def timed(name, operation, repeats, run):
    best = None
    for _ in range(repeats):
        start = time.process_time()
        result = run()
        took = time.process_time() - start
        best = took if best is None else min(best, took)
    show(name, operation, best, "s")
    return result


def write_ply(path, v, f):
    rows = np.empty(len(f), np.dtype([("n", "u1"), ("v", "<i4", 3)]))
    rows["n"], rows["v"] = 3, f
    with open(path, "wb") as out:
        out.write(
            b"ply\nformat binary_little_endian 1.0\nelement vertex %d\nproperty double x\nproperty double y\nproperty double z\n"
            b"element face %d\nproperty list uchar int vertex_indices\nend_header\n" % (len(v), len(f))
        )
        out.write(np.ascontiguousarray(v, "<f8").tobytes() + rows.tobytes())


def main():
    v, f = read(sys.argv[1])
    repeats = int(sys.argv[2])
    start = sys.argv[3] if len(sys.argv) > 3 else None
    few = len(f) // 10
    show("igl", "midpoint_faces", len(timed("igl", "midpoint", repeats, lambda: igl.upsample(v, f))[1]), "faces")
    show("igl", "loop_faces", len(timed("igl", "loop", repeats, lambda: igl.loop(v, f))[1]), "faces")
    timed("igl", "normals", repeats, lambda: (igl.per_vertex_normals(v, f), igl.per_face_normals(v, f, np.zeros(3))))
    half = f.copy()
    half[::2] = half[::2, ::-1]
    timed("igl", "unify", repeats, lambda: igl.bfs_orient(half))
    soup = v[f.ravel()]
    welded = timed("igl", "weld_soup", repeats, lambda: igl.remove_duplicate_vertices(soup, 0.0))
    show("igl", "weld_soup_edges", len(welded[0]), "vertices")

    def fast():
        return fast_simplification.simplify(v.astype(np.float32), f.astype(np.int32), target_count=few)

    def meshlib(faces):
        mesh = mrn.meshFromFacesVerts(f.astype(np.int32), v)

        def run():
            settings = mr.DecimateSettings()
            settings.maxDeletedFaces = len(f) - faces
            settings.maxError = 1e30
            mr.decimateMesh(mesh, settings)
            mesh.pack()
            return mrn.getNumpyVerts(mesh), mrn.getNumpyFaces(mesh.topology)

        return run

    volume = manifold3d.Mesh64(vert_properties=v, tri_verts=f.astype(np.uint64))
    solid = timed("manifold", "build_solid", repeats, lambda: manifold3d.Manifold(volume))
    if solid.status() == manifold3d.Error.NoError:
        show("manifold", "volume_checksum", solid.volume(), "volume")
        show("manifold", "midpoint_faces", timed("manifold", "midpoint", repeats, lambda: solid.refine(2)).num_tri(), "faces")

    results = {"fast_simplification_f32": timed("fast_simplification_f32", "reduce", 1, fast)}
    results["meshlib_f32"] = timed("meshlib_f32", "reduce", 1, meshlib(few))
    for name, (rv, rf) in results.items():
        show(name, "reduce_faces", len(rf), "faces")
        if start:
            write_ply(f"{start}.{name}.ply", rv, rf)


if __name__ == "__main__":
    main()
