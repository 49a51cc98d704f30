#!/usr/bin/env bash
# Times meshwright beside OpenMesh and CGAL on the same shapes, in turns, and prints the least time of each with the ratio
# of ours to the better peer. Usage: benches/peers/run.sh [--quick]
set -euo pipefail
cd "$(dirname "$0")/../.."

rounds=4 repeats=5
[ "${1:-}" = "--quick" ] && rounds=1 repeats=2

for header in OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh CGAL/Surface_mesh.h; do
  if ! echo "#include <$header>" | g++ -fsyntax-only -x c++ - 2>/dev/null; then
    echo "the peers need g++, libopenmesh-dev and libcgal-dev (Debian packages)" >&2
    exit 2
  fi
done

out=${CARGO_TARGET_DIR:-target}/peers
mkdir -p "$out"
for peer in openmesh cgal; do
  source=benches/peers/$peer.cpp
  if [ ! -x "$out/$peer" ] || [ "$source" -nt "$out/$peer" ] || [ benches/peers/shape.hpp -nt "$out/$peer" ]; then
    libraries=()
    [ "$peer" = openmesh ] && libraries=(-lOpenMeshTools -lOpenMeshCore)
    [ "$peer" = cgal ] && libraries=(-lgmp -lmpfr)
    g++ -std=c++17 -O3 -DNDEBUG -o "$out/$peer" "$source" "${libraries[@]}"
  fi
done
cargo build --quiet --release --bench peers
ours() { cargo bench --quiet --bench peers -- "$@"; }
[ -s "$out/grid2m.raw" ] && [ -s "$out/scattered1m.raw" ] || ours --write "$out"

for shape in sphere1m scattered1m grid2m; do
  lines=$out/$shape.tsv
  : > "$lines"
  for ((round = 0; round < rounds; round++)); do
    ours --time "$out/$shape.raw" --repeats "$repeats" >> "$lines"
    "$out/openmesh" "$out/$shape.raw" "$repeats" >> "$lines"
    "$out/cgal" "$out/$shape.raw" "$repeats" >> "$lines"
  done
  echo
  awk -F'\t' -v shape="$shape" '
    { key = $2 SUBSEP $1; if (!(key in least) || $3 + 0 < least[key]) least[key] = $3 + 0; unit[$2] = $4 }
    !($2 in seen) { seen[$2] = 1; order[++n] = $2 }
    END {
      split("meshwright openmesh openmesh_f32 cgal", names, " ")
      printf "%-16s %12s %12s %12s %12s  %-10s %s\n", shape, names[1], names[2], names[3], names[4], "unit", "ours / best peer"
      for (i = 1; i <= n; i++) {
        op = order[i]; best = ""; row = ""
        for (j = 1; j <= 4; j++) {
          key = op SUBSEP names[j]
          row = row sprintf(" %12s", (key in least) ? sprintf("%.2f", least[key]) : "-")
          if (j > 1 && (key in least) && (best == "" || least[key] < best)) best = least[key]
        }
        ours = op SUBSEP names[1]
        ratio = ((ours in least) && best != "" && best > 0 && op !~ /checksum|edges$/) ? sprintf("%.2f", least[ours] / best) : ""
        printf "%-16s%s  %-10s %s\n", op, row, unit[op], ratio
      }
    }' "$lines"
done
