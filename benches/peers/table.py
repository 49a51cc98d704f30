"""The tables of run.sh, from the lines it has gathered: the least time or the highest rate of each program, ours beside the
best peer, and whether the bars are reached.

Usage: table.py [--write FILE] FOLDER SHAPE...    (FOLDER holds SHAPE.tsv; exit code 1: programs disagree on a result)
"""

import os
import subprocess
import sys

OURS = "meshwright"
RATES = ("MB/s", "thousand/s")
LEGEND = """Least processor time of one thread (rates: the highest), peers and ours in turns in one run on arrays or files in memory. *Ours is* says how many times
better ours is than the best peer: above 1 is ahead, for rates and bytes too. Peers marked f32 work in single precision, ours and the others in double.
Embree is asked one ray and one point at a time, in random order; ours both ways, one by one and as batches. Normals of OpenMesh are weighted by face,
ours by area. Maps of a subdivision or a weld are made when they are first asked for, and are not in its time. Ratios hold only within one run: measure with `benches/peers/run.sh` on your machine."""


def read(path):
    """Values by operation and program; units by operation."""
    values, units = {}, {}
    for line in open(path):
        name, op, value, unit = line.rstrip("\n").split("\t")
        if op.endswith("_median"):
            continue
        single = "_f32" in op
        op, name = op.replace("_f32", ""), name + ("_f32" if single else "")
        value = float(value)
        known = values.setdefault(op, {})
        better = max if unit in RATES else min
        known[name] = better(known[name], value) if name in known else value
        units[op] = unit
    return values, units


def is_result(op):
    return op.endswith(("_checksum", "_edges", "_found", "_faces", "_vertices", "_done", "_crowded"))


def disagree(op, known):
    """The programs whose result differs from ours; single precision and reductions may differ a little."""
    if OURS not in known or not is_result(op) or op.endswith(("_done", "_crowded")) or op == "reduce_faces":
        return []
    ours = known[OURS]
    slack = lambda name: 1e-3 if name.endswith("_f32") else 1e-6
    return [n for n, v in known.items() if abs(v - ours) > 0.05 + slack(n) * abs(ours)]


def short(value):
    return f"{value:.3g}" if abs(value) < 1000 else f"{value:.0f}"


def times_better(ours, peer, unit):
    return ours / peer if unit in RATES else peer / ours


def rows(values, units):
    """Operation, unit, ours, the best peer, how many times better ours is, the others."""
    for op, known in values.items():
        if is_result(op) or op.startswith("threads"):
            continue
        peers = sorted(
            ((v, n) for n, v in known.items() if n != OURS and not n.startswith("threads")),
            reverse=units[op] in RATES,
        )
        if OURS not in known and not peers:
            continue
        ours = known.get(OURS)
        best = f"{peers[0][1]} {short(peers[0][0])}" if peers else ""
        ratio = f"{times_better(ours, peers[0][0], units[op]):.2f}" if ours and peers and peers[0][0] else ""
        others = ", ".join(f"{n} {short(v)}" for v, n in peers[1:])
        yield op, units[op], short(ours) if ours is not None else "", best, ratio, others


def table(head, body):
    body = [list(map(str, row)) for row in body]
    widths = [max(len(r[i]) for r in [head, *body]) for i in range(len(head))]
    line = lambda row: "| " + " | ".join(c.ljust(w) for c, w in zip(row, widths)).rstrip() + " |"
    return "\n".join([line(head), "|" + "|".join("-" * (w + 2) for w in widths) + "|", *map(line, body)])


def bars(shapes):
    """What the project asks of itself: name, what is wanted, what was measured, whether that is enough."""

    def get(shape, op, *names):
        known = shapes.get(shape, ({}, {}))[0].get(op, {})
        found = [known[n] for n in (names or [n for n in known if n != OURS and not n.startswith("threads")]) if n in known]
        return found

    def ours(shape, op):
        return next(iter(get(shape, op, OURS)), None)

    def faster(title, shape, op, factor, *names, beside=None):
        mine, peers, unit = ours(shape, op), get(shape, beside or op, *names), shapes[shape][1].get(op, "")
        if mine is None or not peers:
            return [(f"{title}, {shape}", f"{factor} times", "not measured", "")]
        ratio = times_better(mine, (max if unit in RATES else min)(peers), unit)
        return [(f"{title}, {shape}", f"{factor} times", f"{ratio:.2f} times", "yes" if ratio >= factor else "no")]

    def at_least(title, shape, op, wanted, unit, sign=1):
        mine = ours(shape, op)
        if mine is None:
            return [(f"{title}, {shape}", f"{wanted} {unit}", "not measured", "")]
        word = "at least" if sign > 0 else "at most"
        return [(f"{title}, {shape}", f"{word} {wanted} {unit}", f"{short(mine)} {unit}", "yes" if sign * mine >= sign * wanted else "no")]

    def threads(title, shape, op, wanted):
        one, two = get(shape, op, "threads1"), get(shape, op, "threads2")
        if not one or not two:
            return [(f"{title}, two threads, {shape}", f"{wanted} times", "not measured", "")]
        ratio = one[0] / two[0]
        return [(f"{title}, two threads, {shape}", f"{wanted} times", f"{ratio:.2f} times", "yes" if ratio >= wanted else "no")]

    for shape in shapes:
        if shape == "scattered1m":
            yield from faster("one-ring sweep after our ordering", shape, "ring_ordered", 3, "cgal", "openmesh", beside="ring")
            continue
        yield from faster("build from arrays", shape, "build", 1, "openmesh", "openmesh_f32", "cgal")
        yield from at_least("memory of the mesh", shape, "memory", 104, "bytes/face", -1)
        memory = ours(shape, "memory")
        yield from at_least("peak of the build", shape, "peak", round(2 * memory) if memory else 208, "bytes/face", -1)
        yield from faster("one-ring sweep", shape, "ring", 1, "cgal", "openmesh")
        yield from faster("reduce to 10 % beside meshoptimizer", shape, "reduce", 1, "meshopt_f32")
        yield from faster("reduce beside OpenMesh", shape, "reduce", 8, "openmesh")
        yield from faster("mean distance beside Lindstrom-Turk", shape, "reduce_mean", 1, "cgal")
        yield from faster("maximum distance beside Lindstrom-Turk", shape, "reduce_max", 1, "cgal")
        yield from threads("reduce", shape, "reduce", 1.4)
        for op in ("loop", "catmull_clark", "midpoint", "normals"):
            yield from faster(op.replace("_", "-"), shape, op, 1.5)
        yield from faster("unify", shape, "unify", 8, "cgal")
        yield from faster("weld of the soup", shape, "weld_soup", 8, "cgal")
        yield from faster("soup to validated mesh", shape, "soup_to_mesh", 5, "cgal")
        yield from faster("first hit", shape, "first_hit", 0.5, "embree_f32")
        yield from faster("first hit, asked in a batch", shape, "first_hit_batch", 0.5, "embree_f32", beside="first_hit")
        yield from faster("any hit", shape, "is_hit", 0.5, "embree_f32")
        yield from faster("any hit, asked in a batch", shape, "is_hit_batch", 0.5, "embree_f32", beside="is_hit")
        yield from faster("closest point", shape, "closest_point", 1, "embree_f32")
        yield from faster("closest point, asked in a batch", shape, "closest_point_batch", 1, "embree_f32", beside="closest_point")
        yield from faster("reading OBJ beside tobj", shape, "read_obj", 0.85, "tobj")
        yield from at_least("reading binary PLY", shape, "read_ply", 400, "MB/s")
        yield from at_least("reading binary STL and welding", shape, "read_stl_weld", 300, "MB/s")


def versions():
    def ask(*command):
        try:
            return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()
        except (OSError, subprocess.CalledProcessError):
            return ""

    cpu = next((l.split(":", 1)[1].strip() for l in open("/proc/cpuinfo") if l.startswith("model name")), "unknown")
    debian = ask("dpkg-query", "-W", "-f", "${Package} ${Version}\n", "libopenmesh-dev", "libcgal-dev", "libembree-dev")
    lock = open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "crates", "Cargo.lock")).read().split("[[package]]")
    crates = {}
    for package in lock[1:]:
        entry = dict(l.split(" = ", 1) for l in package.splitlines() if " = " in l)
        crates[entry["name"].strip('"')] = entry["version"].strip('"')
    pypi = open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "requirements.txt")).read().replace("==", " ").splitlines()
    yield f"{os.cpu_count()} cores of {cpu}; {ask('rustc', '--version')}; {ask('g++', '--version').splitlines()[0]}; commit {ask('git', 'rev-parse', '--short', 'HEAD')}"
    yield "Debian: " + ", ".join(debian.splitlines())
    yield "crates.io: " + ", ".join(f"{n} {crates[n]}" for n in ("alum", "halfedge", "meshopt", "parry3d-f64", "tobj") if n in crates)
    yield "PyPI: " + ", ".join(p for p in pypi if not p.startswith(("numpy", "scipy")))


def main():
    args = sys.argv[1:]
    target = None
    if args[0] == "--write":
        target, args = args[1], args[2:]
    folder, names = args[0], args[1:]
    shapes = {name: read(os.path.join(folder, f"{name}.tsv")) for name in names}
    text = ["# Benchmarks", "", LEGEND, "", *(f"- {v}" for v in versions()), "", "## Bars", ""]
    text.append(table(["bar", "wanted", "measured", "reached"], bars(shapes)))
    wrong = []
    for name, (values, units) in shapes.items():
        text += ["", f"## {name}", "", table(["operation", "unit", "ours", "best peer", "ours is", "the others"], rows(values, units)), ""]
        agreed = []
        for op, known in values.items():
            off = disagree(op, known)
            wrong += [(name, op, n, known[n], known[OURS]) for n in off]
            if is_result(op) and not off and len(known) > 1 and OURS in known:
                agreed.append(op)
        text.append("Agree: " + ", ".join(agreed) + ".")
        crowded = {n: int(v) for n, v in values.get("reduce_crowded", {}).items() if v}
        if crowded:
            text.append("Edges with three or more faces after reducing: " + ", ".join(f"{n} {v}" for n, v in crowded.items()) + ".")
        others = [f"{op} of {n} {short(v)} against {short(mine)}" for shape, op, n, v, mine in wrong if shape == name]
        if others:
            text += ["", "**Different: " + ", ".join(others) + "**"]
    text = "\n".join(text) + "\n"
    print(text)
    if target:
        open(target, "w").write(text)
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
