#!/usr/bin/env bash
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
#
# Prints the figures of the registration: errors on simulated captures with truth, and on a real recording how far
# calibrations from 20 random guesses lie apart and how they score against the evaluation masks.
#   scripts/evaluate.sh [DATA_DIR]     (default: ../shared/data; the judge is looked for in ../tools/judge beside it)
set -euo pipefail
cd "$(dirname "$0")/.."
data=${1:-../shared/data}
bench=build/release/bin/calibrd-bench
[ -d "$data" ] || { echo "evaluate.sh: no data at $data; name its folder" >&2; exit 2; }
[ -x "$bench" ] || { echo "evaluate.sh: $bench is missing; run scripts/test.sh first" >&2; exit 2; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

echo "== simulated captures, guess 40 mm / 4 deg off (turned about the point 1.3 m ahead)"
for capture in "$data"/sim/*/; do
  "$bench" fine "$capture" --models "$data/models" --offset-mm 40 --offset-deg 4 --seed 7 > "$work/run.jsonl"
  python3 scripts/evaluate_table.py row "$(basename "$capture")" < "$work/run.jsonl"
done

real=$data/real/lbr_med7_zed2i
echo "== $real: 20 guesses up to 50 mm / 5 deg off HT_hydra_robust"
python3 -c 'import json,sys; json.dump(json.load(open(sys.argv[1]))["HT_hydra_robust"], open(sys.argv[2], "w"))' \
  "$real/references.json" "$work/around.json"
"$bench" fine "$real" --around "$work/around.json" --offset-mm 50 --offset-deg 5 --seed 7 --runs 20 --vary > "$work/real.jsonl"
python3 scripts/evaluate_table.py spread < "$work/real.jsonl"

judge=$data/../tools/judge
if [ -f "$judge/score.cpp" ] && cp "$judge"/* "$work" && g++ -w -O2 -std=c++20 -DBOOST_BIND_GLOBAL_PLACEHOLDERS \
    "$work/score.cpp" -o "$work/score" -I/usr/include/eigen3 -I/usr/include/opencv4 -lembree3 -lurdfdom_model -lassimp \
    -lopencv_core -lopencv_imgcodecs -lopencv_imgproc 2> "$work/judge.log"; then
  python3 scripts/evaluate_table.py poses < "$work/real.jsonl" | "$work/score" "$real"
else
  echo "(not scored: the judge or what it builds with is missing: libembree-dev libopencv-imgcodecs-dev libopencv-imgproc-dev)"
fi
