"""How far reduced meshes are from their original: libigl's qslim beside the results of other programs.

Usage: reduce.py ORIGINAL FACES NAME=RESULT.ply... [--lines]    (the original as .ply or .raw; NAME=qslim has libigl make it;
--lines prints as the other programs here do, lengths in millionths of the diagonal)

Points are spread over both surfaces by area; the distance from each to the other surface gives the mean (the greater of the
two directions) and the maximum, as shares of the box's diagonal. Edges with three or more faces are counted: no result of a
reduction should have any. Needs libigl: the environment that the tests make has it.
"""

import sys
import time

import igl
import numpy as np

SAMPLES = 400_000


def read(path):
    """Vertices and triangles of a binary PLY file of doubles, or of an ASCII one."""
    data = open(path, "rb").read()
    if path.endswith(".raw"):
        n, m = np.frombuffer(data, "<u8", 2)
        v = np.frombuffer(data, "<f8", 3 * n, 16).reshape(n, 3).copy()
        return v, np.frombuffer(data, "<u4", 3 * m, 16 + 24 * n).reshape(m, 3).astype(np.int64)
    end = data.index(b"end_header\n") + len(b"end_header\n")
    header = data[:end].decode().splitlines()
    count = {line.split()[1]: int(line.split()[2]) for line in header if line.startswith("element")}
    n, m = count["vertex"], count["face"]
    if "format ascii 1.0" in header:
        rows = data[end:].split(b"\n")
        v = np.array([row.split()[:3] for row in rows[:n]], dtype=float)
        return v, np.array([row.split()[1:4] for row in rows[n : n + m]], dtype=np.int64)
    wide = any(line.startswith("property double x") for line in header)
    v = np.frombuffer(data, "<f8" if wide else "<f4", 3 * n, end).reshape(n, 3).astype(float)
    rows = np.frombuffer(data, np.dtype([("n", "u1"), ("v", "<i4", 3)]), m, end + n * 3 * (8 if wide else 4))
    assert (rows["n"] == 3).all()
    return v, np.ascontiguousarray(rows["v"].astype(np.int64))


def spread(v, f, rng):
    """Points on the surface, by area, and the vertices."""
    area = igl.doublearea(v, f)
    at = rng.choice(len(f), SAMPLES, p=area / area.sum())
    a, b = np.sqrt(rng.random(SAMPLES)), rng.random(SAMPLES)
    corners = v[f[at]]
    points = (1 - a)[:, None] * corners[:, 0] + (a * (1 - b))[:, None] * corners[:, 1] + (a * b)[:, None] * corners[:, 2]
    return points, v[np.unique(f)]


def distances(v, f, w, g, diagonal):
    """Mean, maximum, and the root of the mean square."""
    mean = square = most = 0.0
    for (a, b), (c, d) in [((v, f), (w, g)), ((w, g), (v, f))]:
        points, corners = spread(a, b, np.random.default_rng(1))
        d2 = np.maximum(igl.point_mesh_squared_distance(points, c, d)[0], 0)
        corner2 = np.maximum(igl.point_mesh_squared_distance(np.ascontiguousarray(corners), c, d)[0], 0)
        mean = max(mean, np.sqrt(d2).mean())
        square = max(square, np.sqrt(d2.mean()))
        most = max(most, np.sqrt(max(d2.max(), corner2.max())))
    return [x / diagonal for x in (mean, most, square)]


def crowded(f):
    """How many edges have three or more faces."""
    edges = np.sort(f[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    return int((np.unique(edges[:, 0] << 32 | edges[:, 1], return_counts=True)[1] > 2).sum())


def main():
    """Prints a line per result."""
    v, f = read(sys.argv[1])
    faces = int(sys.argv[2])
    diagonal = np.linalg.norm(v.max(0) - v.min(0))
    results = {}
    for argument in (a for a in sys.argv[3:] if a != "--lines"):
        name, path = argument.rsplit("=", 1)
        results[name] = path if path == "qslim" else read(path)
    for name, result in results.items():
        note = ""
        if result == "qslim":
            start = time.process_time()
            w, g = igl.qslim(v, f, max_m=faces)[:2]
            note = f"{time.process_time() - start:.2f} s"
            result = np.asarray(w), np.asarray(g).astype(np.int64)
        mean, most, square = distances(v, f, *result, diagonal)
        if "--lines" in sys.argv:
            for what, value, unit in [("mean", mean * 1e6, "ppm"), ("max", most * 1e6, "ppm"), ("crowded", crowded(result[1]), "edges")]:
                print(f"{name}\treduce_{what}\t{value:.3f}\t{unit}", flush=True)
            continue
        row = f"{name:14} {len(result[1]):8} faces  mean {mean:.3e}  max {most:.3e}  rms {square:.3e}"
        print(f"{row}  crowded edges {crowded(result[1])}  {note}", flush=True)


if __name__ == "__main__":
    main()
