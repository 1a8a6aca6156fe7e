#!/usr/bin/env bash
# Makes report/: the measurements (CSV), their pictures and report.md. Called by `make report`, which sets the paths.
# QUICK=1 takes small scenes only; SEED and RANDOM_SCENES choose the random ones.
set -u
root=$(cd "$(dirname "$0")/../.." && pwd)
mkdir -p "$root/report/examples"  # its pictures are the manual's own
cd "$root/report" || exit 1
rm -f ./*.csv ./*.txt ./*.png ./*.md
# One thread, but where a script sets more by threads()
export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1
quick=${QUICK:-0}
script() { FreeFem++-nw -nw -v 0 "$root/tests/bench/$1.edp" -quick "$quick"; }
step() { printf '%(%T)T %s ...\n' -1 "$1"; }

step "error against run time, all methods"
script errorTime || exit 1
step "peers"
if [ -e /usr/lib/freefem++/ff-Ipopt.so ]; then
    script ipopt >ipopt.log 2>&1 || echo "ff-Ipopt stopped early: see report/ipopt.log"
else
    echo "ff-Ipopt is not installed: left out"
fi
/usr/bin/python3 -c 'import numpy, scipy' 2>/dev/null &&
    /usr/bin/python3 "$root/tests/bench/peers.py" systems.txt peers.csv ||
    echo "the peers in Python did not run: left out"
rm -f system_*.bin peer_matrix.mtx ipopt.out
step "cost of the default, of one body and of two"
script cost || exit 1
step "3D by default"
script multigrid3d >multigrid3d.log || exit 1
step "total error"
script totalError >totalError.log || exit 1
step "two bodies: NAFEMS CB1"
script roller >roller.log || exit 1
/usr/bin/python3 "$root/tests/bench/rollerPeer.py" roller.csv >>roller.log 2>&1 ||
    echo "GetFEM did not run: left out of CB1"
rm -f roller_*.msh
step "stability"
script stress || exit 1
step "random scenes"
RANDOM_SCENES=${RANDOM_SCENES:-$((quick ? 200 : 10000))} RANDOM_SEED=${SEED:-$RANDOM} \
    "$root/build/unit_tests" --gtest_filter='RandomScenes.*' >random.log
grep ' scenes from seed' random.log | tee random.txt
! grep 'off by' random.log || exit 1  # what is not solved is counted; what is wrong ends the report
step "what is left out"
script leftOut >left_out.txt || exit 1
step "examples that the manual quotes"
(cd examples && for example in roller wedge crack; do
    FreeFem++-nw -nw -v 0 "$root/examples/$example.edp" || exit 1
done) >examples.log || exit 1
awk '/^P[12], a\/h = 16/ {
         sub(",", "", $1); printf "roller, %s\t%.2f and %.2f %%\n", $1, $8 < 0 ? -$8 : $8, $12 < 0 ? -$12 : $12 }
     /^wedge (up|down)/ { sub(/.*off by /, ""); if ($1 + 0 > most) most = $1 + 0 }
     /^slip over the whole loop/ { sub(/.*off by /, ""); printf "crack\t%.1f %%\n", $1 }
     END { printf "wedge\t%.0e\n", most }' examples.log >examples.txt
if command -v valgrind >/dev/null; then
    step "leaks"
    valgrind --leak-check=full --log-file=leaks.log \
        FreeFem++-nw -nw -v 0 "$root/tests/bench/leaks.edp" >/dev/null 2>&1
    lost=$(grep -A30 'are definitely lost' leaks.log | grep -c 'frictionCG\.so')
    echo "valgrind, 1000 calls: $lost leaks in frictionCG.so (FreeFEM's own:$(grep 'definitely lost:' leaks.log |
        sed 's/.*lost://'))" | tee leaks.txt
    [ "$lost" = 0 ] || exit 1
fi
step "summary"
/usr/bin/python3 "$root/tests/bench/summary.py" || exit 1
echo "to publish it: rm tests/bench/report/*; cp report/*.md report/*.png report/figures.txt tests/bench/report && tests/figures write"
