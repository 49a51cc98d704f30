#!/usr/bin/env bash
# Times meshwright beside OpenMesh and CGAL on the same shapes, in turns, and prints the least value of each operation with
# the ratio of ours to the best peer: among those that store f64 as we do, and among all.
# Usage: benches/peers/run.sh [--quick]
# Debian's OpenMesh library is compiled with assertions, so its core is compiled here from the sources of the same
# version, in OPENMESH_SOURCE or target/peers/OpenMesh-9.0.0. Without them OpenMesh's build has no part in the ratios.
# Every line measured, medians too, stays in target/peers/SHAPE.tsv. Exit code 1: the programs disagree on a result;
# 2: wrong usage, or a peer is not installed.
set -euo pipefail
cd "$(dirname "$0")/../.."

rounds=4 repeats=5
case "$#:${1:-}" in
  0:) ;;
  1:--quick) rounds=2 repeats=2 ;;
  *) echo "usage: benches/peers/run.sh [--quick]" >&2; exit 2 ;;
esac

missing=()
if ! command -v g++ > /dev/null; then
  missing=(g++ libopenmesh-dev libcgal-dev)
else
  has() { echo "#include <$1>" | g++ -std=c++17 -E -x c++ - > /dev/null 2>&1; }
  has OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh || missing+=(libopenmesh-dev)
  has CGAL/Surface_mesh.h || missing+=(libcgal-dev)
fi
if [ ${#missing[@]} -gt 0 ]; then
  echo "missing for the peers, as Debian packages: apt-get install ${missing[*]}" >&2
  exit 2
fi

out=${CARGO_TARGET_DIR:-target}/peers
mkdir -p "$out"
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
  echo "OpenMesh's build is not compared: Debian's library has assertions in it. To compare it, unpack the" >&2
  echo "sources of Debian's package openmesh (apt-get source openmesh) as $out/OpenMesh-9.0.0." >&2
  openmesh=(-DCORE_ASSERTS -lOpenMeshCore)
fi
g++ -std=c++17 -O3 -DNDEBUG -o "$out/openmesh" benches/peers/openmesh.cpp "${openmesh[@]}"
g++ -std=c++17 -O3 -DNDEBUG -o "$out/cgal" benches/peers/cgal.cpp

# Our bench is built once and its program run, so that an edit of the sources during the rounds changes nothing.
cargo bench --quiet --no-run --bench peers --bench operators
for bench in peers operators; do
  ours=$(cargo bench --quiet --no-run --bench "$bench" --message-format=json |
    sed -n 's/.*"name":"'"$bench"'".*"executable":"\([^"]*\)".*/\1/p')
  cp "$ours" "$out/meshwright_$bench"
done
"$out/meshwright_peers" --write "$out"

load() { cut -d' ' -f1-3 /proc/loadavg; }
echo "$(nproc) cores, load $(load); least of $rounds rounds of $repeats repeats"
agree=0
for shape in sphere1m scattered1m grid2m; do
  lines=$out/$shape.tsv
  : > "$lines"
  for ((round = 0; round < rounds; round++)); do
    "$out/meshwright_peers" --time "$out/$shape.raw" --repeats "$repeats" >> "$lines"
    "$out/meshwright_operators" --time "$out/$shape.raw" --repeats "$repeats" >> "$lines"
    "$out/openmesh" "$out/$shape.raw" "$repeats" >> "$lines"
    "$out/cgal" "$out/$shape.raw" "$repeats" >> "$lines"
  done
  echo
  awk -F'\t' -v shape="$shape" '
    function ratio(ours, best) { return ours == "" || best == "" || best <= 0 ? "" : sprintf("%.2f", ours / best) }
    $2 ~ /_median$/ { next }
    {
      name = $1; op = $2
      if (sub(/_f32$/, "", op)) name = name "_f32"
      if (!(op in unit)) { unit[op] = $4; order[++n] = op }
      if (op ~ /checksum$|_edges$/) {
        if (!(op in first)) first[op] = $3
        off = $3 - first[op]; size = first[op] < 0 ? -first[op] : first[op]
        if (off < 0) off = -off
        if (off > 0.05 + 1e-7 * size) wrong[op] = 1
      }
      if (!((op, name) in least) || $3 + 0 < least[op, name]) least[op, name] = $3 + 0
    }
    END {
      columns = split("meshwright openmesh cgal openmesh_f32", names, " ")
      printf "%-16s", shape
      for (j = 1; j <= columns; j++) printf " %14s", names[j]
      printf "  %-10s %9s %9s\n", "unit", "ours/f64", "ours/all"
      for (i = 1; i <= n; i++) {
        op = order[i]; double = all = ""
        printf "%-16s", op
        for (j = 1; j <= columns; j++) {
          value = (op, names[j]) in least ? least[op, names[j]] : ""
          printf " %14s", value == "" ? "-" : sprintf("%.2f", value)
          if (j == 1 || value == "") continue
          if (all == "" || value < all) all = value
          if (names[j] !~ /_f32$/ && (double == "" || value < double)) double = value
        }
        ours = (op, names[1]) in least ? least[op, names[1]] : ""
        if (op ~ /_done$/) printf "  %-10s\n", unit[op]
        else if (op ~ /checksum$|_edges$/) printf "  %-10s %9s\n", unit[op], op in wrong ? "DIFFERENT" : "agree"
        else printf "  %-10s %9s %9s\n", unit[op], ratio(ours, double), ratio(ours, all)
      }
      for (op in wrong) exit 1
    }' "$lines" || agree=1
done
echo
echo "load at the end $(load)"
exit "$agree"
