#!/usr/bin/env bash
# Makes report/: the measurements (CSV), their pictures and report.md. Called by `make report`, which sets the paths.
# QUICK=1 takes small scenes only; SEED chooses the random ones.
set -u
root=$(cd "$(dirname "$0")/../.." && pwd)
mkdir -p "$root/report"
cd "$root/report" || exit 1
rm -f ./*.csv ./*.txt ./*.png ./*.md
export OPENBLAS_NUM_THREADS=1
quick=${QUICK:-0}
script() { FreeFem++-nw -nw -v 0 "$root/tests/bench/$1.edp" -quick "$quick"; }

echo "error against run time, all methods ..."
script errorTime || exit 1
echo "total error ..."
script totalError || exit 1
echo "cost of the default route, of one body and of two ..."
script cost >cost.txt || exit 1
script costPair >costPair.txt || exit 1
echo "peers ..."
if [ -e /usr/lib/freefem++/ff-Ipopt.so ]; then
    script ipopt >ipopt.log 2>&1 || echo "ff-Ipopt stopped early: see report/ipopt.log"
else
    echo "ff-Ipopt is not installed: left out"
fi
/usr/bin/python3 -c 'import numpy, scipy' 2>/dev/null &&
    /usr/bin/python3 "$root/tests/bench/peers.py" systems.txt peers.csv ||
    echo "the peers in Python did not run: left out"
rm -f system_*.bin peer_matrix.mtx ipopt.out
echo "two bodies: NAFEMS CB1 ..."
script roller >roller.log || exit 1
/usr/bin/python3 "$root/tests/bench/rollerPeer.py" roller.csv >>roller.log 2>&1 ||
    echo "GetFEM did not run: left out of CB1"
rm -f roller_*.msh
echo "3D by multigrid ..."
script multigrid3d >multigrid3d.log || exit 1
echo "stability ..."
script stress || exit 1
echo "random scenes ..."
RANDOM_SCENES=10000 RANDOM_SEED=${SEED:-$RANDOM} "$root/build/unit_tests" --gtest_filter='RandomScenes.*' >random.log
grep ' scenes from seed' random.log | tee random.txt
! grep 'off by' random.log || exit 1  # what is not solved is counted; what is wrong ends the report
echo "what is left out ..."
script leftOut >left_out.txt || exit 1
grep 'no friction:' left_out.txt
echo "examples that the manual quotes ..."
mkdir -p examples  # their pictures are the manual's own
(cd examples && for example in roller wedge crack; do
    FreeFem++-nw -nw -v 0 "$root/examples/$example.edp" || exit 1
done) >examples.log || exit 1
awk '/^P[12], a\/h = 16/ {
         sub(",", "", $1); printf "roller, %s\t%.2f and %.2f %%\n", $1, $8 < 0 ? -$8 : $8, $12 < 0 ? -$12 : $12 }
     /^wedge (up|down)/ { sub(/.*off by /, ""); if ($1 + 0 > most) most = $1 + 0 }
     /^slip over the whole loop/ { sub(/.*off by /, ""); printf "crack\t%.1f %%\n", $1 }
     END { printf "wedge\t%.0e\n", most }' examples.log >examples.txt
if command -v valgrind >/dev/null; then
    valgrind --leak-check=full --log-file=leaks.log \
        FreeFem++-nw -nw -v 0 "$root/tests/bench/leaks.edp" >leaks.out 2>&1
    rm -f leaks.out
    lost=$(grep -A30 'are definitely lost' leaks.log | grep -c 'frictionCG\.so')
    echo "valgrind, 1000 calls: $lost leaks in frictionCG.so (FreeFEM's own:$(grep 'definitely lost:' leaks.log |
        sed 's/.*lost://'))" | tee leaks.txt
    [ "$lost" = 0 ] || exit 1
fi
/usr/bin/python3 "$root/tests/bench/summary.py"
echo "to publish it: cp report/*.md report/*.png report/figures.txt tests/bench/report && tests/figures write"
