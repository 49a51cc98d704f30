#!/usr/bin/env bash
# Times meshwright beside its peers on the same shapes, in turns, checks that the results agree, and prints tables of the
# least value of each operation with the ratio of ours to the best peer.
# Usage: benches/peers/run.sh [--quick] [--only SHAPE] [--write BENCHMARKS.md]
# The peers: OpenMesh, CGAL and Embree as Debian packages; alum, halfedge, meshopt, parry3d and tobj from crates.io;
# libigl, fast-simplification, MeshLib and Manifold from PyPI (in an environment of their own under the target directory).
# Debian's OpenMesh library is compiled with assertions, so its core is compiled here from the sources of the same
# version, in OPENMESH_SOURCE or target/peers/OpenMesh-9.0.0. Without them OpenMesh has no part in the ratios.
# Every line measured stays in target/peers/SHAPE.tsv. Exit code 1: the programs disagree on a result; 2: wrong usage, or
# a peer is not installed.
set -euo pipefail
cd "$(dirname "$0")/../.."

rounds=3 repeats=3 shapes="sphere1m scattered1m grid2m" write=()
while [ $# -gt 0 ]; do
  case "$1" in
    --quick) rounds=1 repeats=2 ;;
    --only) shapes=${2:?a shape}; shift ;;
    --write) write=(--write "${2:?a file}"); shift ;;
    *) echo "usage: benches/peers/run.sh [--quick] [--only SHAPE] [--write FILE]" >&2; exit 2 ;;
  esac
  shift
done

missing=()
if ! command -v g++ > /dev/null; then
  missing=(g++ libopenmesh-dev libcgal-dev libembree-dev)
else
  has() { echo "#include <$1>" | g++ -std=c++17 -E -x c++ - > /dev/null 2>&1; }
  has OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh || missing+=(libopenmesh-dev)
  has CGAL/Surface_mesh.h || missing+=(libcgal-dev)
  has embree3/rtcore.h || missing+=(libembree-dev)
fi
python3 -m venv --help > /dev/null 2>&1 || missing+=(python3-venv)
if [ ${#missing[@]} -gt 0 ]; then
  echo "missing for the peers, as Debian packages: apt-get install ${missing[*]}" >&2
  exit 2
fi

out=${CARGO_TARGET_DIR:-target}/peers
mkdir -p "$out"
out=$(cd "$out" && pwd)
here=benches/peers
core=${OPENMESH_SOURCE:-$out/OpenMesh-9.0.0}/src
if [ -f "$core/OpenMesh/Core/Mesh/PolyConnectivity.cc" ]; then
  openmesh=(-w "-I$core")
  for part in Mesh/{Poly,Tri}Connectivity Mesh/{Array,Base}Kernel System/omstream Utils/{BaseProperty,PropertyCreator}; do
    openmesh+=("$core/OpenMesh/Core/$part.cc")
  done
elif [ -n "${OPENMESH_SOURCE:-}" ]; then
  echo "no sources of OpenMesh in $OPENMESH_SOURCE" >&2
  exit 2
else
  echo "OpenMesh is not compared: Debian's library has assertions in it. To compare it, unpack the sources of" >&2
  echo "Debian's package openmesh (apt-get source openmesh) as $out/OpenMesh-9.0.0." >&2
  openmesh=()
fi
# Each is compiled again only when its source is newer.
compile() {
  local program=$out/$1
  if [ "$program" -nt "$here/$1.cpp" ] && [ "$program" -nt "$here/shape.hpp" ]; then return; fi
  g++ -std=c++17 -O3 -DNDEBUG -o "$program" "$here/$1.cpp" "${@:2}"
}
if [ ${#openmesh[@]} -gt 0 ]; then
  compile openmesh "${openmesh[@]}"
  compile openmesh_operations "${openmesh[@]}" "$core/OpenMesh/Tools/Decimater/Observer.cc"
fi
compile cgal
compile cgal_operations
compile reduce
compile embree -lembree3
CARGO_TARGET_DIR=$out/crates cargo build --quiet --release --manifest-path "$here/crates/Cargo.toml"
if ! "$out/venv/bin/python" -c "import igl, fast_simplification, meshlib, manifold3d" 2> /dev/null; then
  python3 -m venv "$out/venv"
  "$out/venv/bin/pip" install --quiet -r "$here/requirements.txt"
fi
python=$out/venv/bin/python

# Our benches are built once and their programs run, so that an edit of the sources during the rounds changes nothing;
# once without threads, which is what the peers are compared with, and once with.
build() {
  local features=("${@:2}") bench
  for bench in peers operators query reduce io; do
    cp "$(cargo bench --quiet --no-run --bench "$bench" "${features[@]}" --message-format=json |
      sed -n 's/.*"name":"'"$bench"'".*"executable":"\([^"]*\)".*/\1/p')" "$out/meshwright_$bench$1"
  done
}
build ""
build _threads --features rayon
"$out/meshwright_peers" --write "$out"
"$out/meshwright_query" --write "$out"

load() { cut -d' ' -f1-3 /proc/loadavg; }
echo "load at the start $(load)" >&2
for shape in $shapes; do
  raw=$out/$shape.raw lines=$out/$shape.tsv
  : > "$lines"
  say() { echo "$shape: $*" >&2; "$@" >> "$lines"; }
  for ((round = 0; round < rounds; round++)); do
    say "$out/meshwright_peers" --time "$raw" --repeats "$repeats"
    say "$out/meshwright_operators" --time "$raw" --repeats "$repeats"
    if [ ${#openmesh[@]} -gt 0 ]; then say "$out/openmesh" "$raw" "$repeats"; fi
    say "$out/cgal" "$raw" "$repeats"
    # The order in memory matters to walks; the rest is measured on two shapes.
    if [ "$shape" = scattered1m ]; then continue; fi
    faces=$(($(od -An -tu8 -j8 -N8 "$raw") / 10))
    say "$out/meshwright_reduce" --shape "$raw" --repeats "$repeats" --write "$out/$shape.meshwright.ply"
    if [ ${#openmesh[@]} -gt 0 ]; then say "$out/openmesh_operations" "$raw" 1 "$out/$shape.openmesh.ply"; fi
    say "$out/cgal_operations" "$raw" 1
    say "$out/crates/release/meshwright-peers" mesh "$raw" 1 "$out/$shape.meshopt_f32.ply"
    say "$out/meshwright_query" --time "$out/$shape.questions" --repeats "$repeats"
    say "$out/embree" "$out/$shape.questions" "$repeats"
    say "$out/crates/release/meshwright-peers" query "$out/$shape.questions" 1
    say "$out/meshwright_io" --shape "$raw"
    for threads in 1 2; do
      "$out/meshwright_reduce_threads" --shape "$raw" --threads "$threads" --repeats "$repeats" \
        --write "$out/$shape.threads$threads.ply" | sed -n "s/^meshwright\treduce_clock\t/threads$threads\treduce\t/p" >> "$lines"
    done
    cmp "$out/$shape.threads1.ply" "$out/$shape.threads2.ply"
  done
  if [ "$shape" = scattered1m ]; then continue; fi
  # Slow ones, once.
  say "$python" "$here/arrays.py" "$raw" 1 "$out/$shape"
  say "$out/reduce" "$raw" "$faces" "$out/$shape.cgal.ply"
  results=()
  for name in meshwright openmesh cgal meshopt_f32 fast_simplification_f32 meshlib_f32; do
    if [ -f "$out/$shape.$name.ply" ]; then results+=("$name=$out/$shape.$name.ply"); fi
  done
  say "$python" "$here/reduce.py" "$raw" "$faces" "${results[@]}" --lines
done
echo "load at the end $(load)" >&2
"$python" "$here/table.py" "${write[@]}" "$out" $shapes
