"""Repairs the same broken meshes with meshwright and with other tools, and prints the results side by side.

Usage: repair.py FAULTS MESHWRIGHT [--only TOOL,TOOL...]

FAULTS is a directory that `cargo bench --bench faults -- FAULTS` writes: `cases.tsv` names each case with its shape and fault;
`CASE.obj` is the broken mesh, `SHAPE.truth.obj` the intact one, `CASE.intact` the faces of it that the fault left alone.
MESHWRIGHT is the program. Each tool runs in a process of its own with a limit of time and memory, and gets the
arrays as its documentation says they are to be repaired; see `repair_*` below. A case is passed if the result is closed,
manifold, oriented, outward (its volume is within 3 % of the truth), without a face of no height, within 0.2 % of the
diagonal of every intact face, and has at least 98 % of the intact faces. Processor time is the repair alone for the
others, the whole program with reading and writing for ours.
"""

import os
import resource
import subprocess
import sys
import tempfile
import time

import numpy as np

TOOLS = ["meshwright", "meshlib", "pymeshlab", "pymeshfix", "trimesh", "nothing"]
SECONDS, BYTES = 60, 6 << 30


def read_obj(path):
    """Vertices and triangles as the file says, whatever that is; faces of more corners become fans."""
    v, f = [], []
    for line in open(path):
        word, *rest = line.split() or [""]
        if word == "v":
            v.append([float(x) for x in rest[:3]])
        elif word == "f":
            corners = [int(x.split("/")[0]) - 1 for x in rest]
            f += [[corners[0], b, c] for b, c in zip(corners[1:], corners[2:])]
    return np.array(v, float).reshape(-1, 3), np.array(f, np.int64).reshape(-1, 3)


def read_ply(path):
    """Vertices and triangles of a binary PLY file as meshwright writes it; polygons become fans."""
    raw = open(path, "rb").read()
    end = raw.index(b"end_header\n") + len(b"end_header\n")
    count = {w[1]: int(w[2]) for w in (line.split() for line in raw[:end].decode().splitlines()) if w[0] == "element"}
    v = np.frombuffer(raw, "<f8", 3 * count["vertex"], end).reshape(-1, 3)
    f, at = [], end + 24 * count["vertex"]
    for _ in range(count["face"]):
        corners = np.frombuffer(raw, "<i4", raw[at], at + 1)
        f += [[corners[0], b, c] for b, c in zip(corners[1:], corners[2:])]
        at += 1 + 4 * raw[at]
    return v, np.array(f, np.int64).reshape(-1, 3)


def finite(v, f):
    """What every tool but ours needs first, or it crashes: no index out of range, no face that is not finite."""
    ok = ((f >= 0) & (f < len(v))).all(1)
    f = f[ok]
    f = f[np.isfinite(v).all(1)[f].all(1)]
    return np.where(np.isfinite(v), v, 0.0), f


# How each tool is asked: its own calls for each kind of fault, in the order its documentation or forum recommends.


def repair_meshlib(v, f):
    import meshlib.mrmeshnumpy as arrays
    import meshlib.mrmeshpy as mm

    v, f = finite(v, f)
    diagonal = float(np.linalg.norm(v.max(0) - v.min(0)))
    mesh = arrays.meshFromFacesVerts(f.astype(np.int32), v)
    mm.uniteCloseVertices(mesh, 1e-5 * diagonal, True)
    mm.fixMultipleEdges(mesh)
    params = mm.FixMeshDegeneraciesParams()
    params.maxDeviation = 1e-5 * diagonal
    params.tinyEdgeLength = 1e-7 * diagonal
    mm.fixMeshDegeneracies(mesh, params)
    fill = mm.FillHoleParams()
    fill.metric = mm.getMinAreaMetric(mesh)
    for edge in mesh.topology.findHoleRepresentiveEdges():
        mm.fillHole(mesh, edge, fill)
    if mesh.volume() < 0:
        mesh.topology.flipOrientation()
    return arrays.getNumpyVerts(mesh), arrays.getNumpyFaces(mesh.topology)


def repair_pymeshlab(v, f):
    import pymeshlab

    v, f = finite(v, f)
    ms = pymeshlab.MeshSet(verbose=False)
    ms.add_mesh(pymeshlab.Mesh(v, f.astype(np.int32)))
    ms.meshing_remove_duplicate_vertices()
    ms.meshing_merge_close_vertices(threshold=pymeshlab.PercentageValue(0.001))
    ms.meshing_remove_duplicate_faces()
    ms.meshing_remove_null_faces()
    ms.meshing_remove_t_vertices()
    ms.meshing_repair_non_manifold_edges(method="Remove Faces")
    ms.meshing_repair_non_manifold_vertices(vertdispratio=0)
    ms.meshing_remove_unreferenced_vertices()
    ms.meshing_re_orient_faces_coherently()
    ms.meshing_close_holes(maxholesize=500, newfaceselected=False)
    ms.meshing_re_orient_faces_by_geometry()
    m = ms.current_mesh()
    return m.vertex_matrix(), m.face_matrix()


def repair_pymeshfix(v, f):
    import pymeshfix

    v, f = finite(v, f)
    fix = pymeshfix.MeshFix(v, f.astype(np.int32))
    fix.repair(joincomp=False, remove_smallest_components=False)
    return fix.points, fix.faces


def repair_trimesh(v, f):
    import trimesh

    v, f = finite(v, f)
    mesh = trimesh.Trimesh(v, f, process=True, validate=True)
    mesh.merge_vertices()
    mesh.update_faces(mesh.unique_faces() & mesh.nondegenerate_faces())
    mesh.remove_unreferenced_vertices()
    trimesh.repair.fill_holes(mesh)
    trimesh.repair.fix_normals(mesh, multibody=True)
    return mesh.vertices, mesh.faces


def repair_nothing(v, f):
    return finite(v, f)


def work(tool, given, result):
    """One repair, in a process of its own."""
    resource.setrlimit(resource.RLIMIT_AS, (BYTES, BYTES))
    v, f = read_obj(given)
    repair = globals()["repair_" + tool]
    try:
        repair(np.eye(3), np.array([[0, 1, 2]]))  # so that loading the tool is not counted
    except Exception:
        pass
    start = time.process_time()
    v, f = repair(v, f)
    np.savez(result, v=np.asarray(v, float), f=np.asarray(f, np.int64), cpu=time.process_time() - start)


def run(tool, program, given, folder):
    """Vertices, triangles and processor time of a repair; or why there is none."""
    if tool == "meshwright":
        result = os.path.join(folder, "out.ply")
        command = [program, "clean", given, "-o", result, "--profile", "solid", "--threads", "1"]
    else:
        result = os.path.join(folder, "out.npz")
        command = [sys.executable, __file__, "--work", tool, given, result]
    if os.path.exists(result):
        os.remove(result)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    try:
        done = subprocess.run(command, capture_output=True, timeout=SECONDS)
    except subprocess.TimeoutExpired:
        return "hangs"
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    if done.returncode < 0:
        return "crashes"
    if not os.path.exists(result):
        return "fails"
    if tool != "meshwright":
        got = np.load(result)
        return got["v"], got["f"], float(got["cpu"])
    return (*read_ply(result), cpu)


def judge(v, f, truth, intact):
    """Why a result is not the truth mended, or None; the share of intact faces kept; how far the surface moved."""
    import igl
    from scipy.spatial import cKDTree

    tv, tf = truth
    diagonal = np.linalg.norm(tv.max(0) - tv.min(0))
    if len(f) == 0:
        return "nothing left", 0.0, np.inf
    v = np.ascontiguousarray(v, float)
    used, f = np.unique(f, return_inverse=True)
    v, f = v[used], f.reshape(-1, 3)
    # Faces of the truth that are there: by which of its vertices each vertex is.
    distance, near = cKDTree(tv).query(v)
    near = np.where(distance <= 1e-3 * diagonal, near, -1)
    have = {tuple(sorted(t)) for t in near[f].tolist()}
    # Vertices of the truth may share a place.
    first = cKDTree(tv).query(tv)[1]
    kept = np.mean([tuple(sorted(t)) in have for t in first[tf[intact]].tolist()]) if len(intact) else 1.0
    corners = tv[tf[intact]]
    points = np.concatenate([corners.mean(1), *corners.transpose(1, 0, 2), *(corners + corners[:, [1, 2, 0]]).transpose(1, 0, 2) / 2])
    moved = np.sqrt(igl.point_mesh_squared_distance(points, v, f)[0].max()) / diagonal if len(intact) else 0.0
    a, b = np.concatenate([f, f[:, [1, 2, 0]], f[:, [2, 0, 1]]])[:, :2].T
    edges = np.stack([np.minimum(a, b), np.maximum(a, b)], 1)
    _, which, count = np.unique(edges, axis=0, return_inverse=True, return_counts=True)
    way = np.zeros(len(count))
    np.add.at(way, which.ravel(), np.where(a < b, 1, -1))
    sides = np.stack([np.linalg.norm(v[f[:, i]] - v[f[:, (i + 1) % 3]], axis=1) for i in range(3)], 1)
    height = igl.doublearea(v, f) / np.maximum(sides.max(1), 1e-300)

    def volume(v, f):
        at = v - v.mean(0)
        return np.einsum("ij,ij->i", at[f[:, 0]], np.cross(at[f[:, 1]], at[f[:, 2]])).sum() / 6

    size = volume(tv, tf)
    fault = None
    if (count == 1).any():
        fault = "open"
    elif (count > 2).any() or not np.all(igl.is_vertex_manifold(f)):
        fault = "not manifold"
    elif (way != 0).any():
        fault = "not oriented"
    elif (height <= 1e-12 * diagonal).any():
        fault = "zero area"
    elif not abs(volume(v, f) - size) <= 0.03 * abs(size):
        fault = "volume"
    elif moved > 0.002:
        fault = "moved"
    elif kept < 0.98:
        fault = "faces lost"
    return fault, kept, moved


def main():
    if sys.argv[1:2] == ["--work"]:
        return work(*sys.argv[2:])
    faults, program = sys.argv[1:3]
    only = sys.argv[sys.argv.index("--only") + 1].split(",") if "--only" in sys.argv else TOOLS
    rows = [line.rstrip("\n").split("\t") for line in open(os.path.join(faults, "cases.tsv"))]
    columns, rows = rows[0], rows[1:]
    cases = [dict(zip(columns, row)) for row in rows]
    total = {tool: [0, [], [], 0.0, {}] for tool in only}
    for case in cases:
        given = os.path.join(faults, case["case"] + ".obj")
        truth = read_obj(os.path.join(faults, case["shape"] + ".truth.obj"))
        intact = np.loadtxt(os.path.join(faults, case["case"] + ".intact"), dtype=np.int64, ndmin=1)
        line = []
        for tool in only:
            with tempfile.TemporaryDirectory() as folder:
                got = run(tool, program, given, folder)
            if isinstance(got, str):
                fault, kept, moved, cpu = got, 0.0, np.inf, 0.0
            else:
                fault, kept, moved = judge(got[0], got[1], truth, intact)
                cpu = got[2]
            sums = total[tool]
            sums[0] += fault is None
            sums[1].append(kept)
            sums[2].append(moved)
            sums[3] += cpu
            ok, all_of = sums[4].get(case["fault"], (0, 0))
            sums[4][case["fault"]] = (ok + (fault is None), all_of + 1)
            line.append(f"{tool} {fault or 'passes'}")
        print(case["case"], "; ".join(line), sep=": ", file=sys.stderr, flush=True)
    kinds = list(dict.fromkeys(case["fault"] for case in cases))
    print("| |", " | ".join(only), "|")
    print("|---|" + "---|" * len(only))
    for kind in kinds:
        print(f"| {kind} |", " | ".join("{} of {}".format(*total[tool][4][kind]) for tool in only), "|")
    print(f"| **passed, of {len(cases)}** |", " | ".join(f"**{total[tool][0]}**" for tool in only), "|")
    print("| intact faces kept, mean |", " | ".join(f"{100 * np.mean(total[t][1]):.1f} %" for t in only), "|")
    finite_moved = lambda t: [m for m in total[t][2] if np.isfinite(m)]
    print("| surface moved, of the diagonal, median (most) |", " | ".join(
        f"{np.median(finite_moved(t)):.1e} ({np.max(finite_moved(t)):.1e})" if finite_moved(t) else "-" for t in only), "|")
    print("| processor time, s |", " | ".join(f"{total[tool][3]:.2f}" for tool in only), "|")


if __name__ == "__main__":
    main()
