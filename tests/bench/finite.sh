#!/bin/bash
# Error against run time of large sliding: the ironing of two elastic bodies on meshes of n and in so many dragging increments,
# beside a fine computation. Writes finite.csv: the errors of the work of the punch and of the force along, in percent.
#
#   finite.sh [n of the fine mesh] [its increments]      FF_LOADPATH and FF_INCLUDEPATH lead to the plugin
set -e
fine=${1:-16} most=${2:-40}
scene=$(dirname "$(readlink -f "$0")")/../../examples/ironing2.edp
here=$(mktemp -d) && trap 'rm -r "$here"' EXIT
sed '/^assert(/d; /^if (n == 6) assert/d; /^frictionCGlength/,$d' "$scene" >"$here/ironing2.edp"
run() { # n, increments: dofs, steps, seconds, work, force along
  (cd "$here" && FreeFem++ -nw -v 0 ironing2.edp -n "$1" -along "$2") |
    sed -n 's/^ironing of two bodies, \([0-9]*\) dofs: .*, \([0-9]*\) Newton steps, .* halved, \([^ ]*\) s; force \([^ ]*\) along.*; work \([^ ]*\) N.*/\1 \2 \3 \5 \4/p'
}
read -r _ _ _ work force < <(run "$fine" "$most")
echo "n,increments,dofs,steps,seconds,work off [%],force off [%]" | tee finite.csv
for n in 4 6 8 12; do
  for k in 3 10 40; do
    run "$n" "$k" | awk -v n="$n" -v k="$k" -v w="$work" -v f="$force" '
      function off(x, y) { return 100 * sqrt((x / y - 1)^2) }
      { printf "%d,%d,%d,%d,%.2f,%.2f,%.2f\n", n, k, $1, $2, $3, off($4, w), off($5, f) }' | tee -a finite.csv
  done
done
