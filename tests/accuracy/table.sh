#!/bin/sh
# Prints the table of docs/accuracy.md: runs the accuracy and stability tests of the build in $1 and gathers the rows they report.
# Exits 1 where a test fails: no table of failing figures.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
export SMELT_ACCURACY_FOLDER="$folder"
if ! ctest --test-dir "$1" --no-tests=error -j "$(nproc)" -R '^(accuracy|stability)\.' >"$folder/log" 2>&1; then
  cat "$folder/log" >&2
  exit 1
fi
# Problem, quantity, resolution, error, bar, order, least order (tests/accuracy/measure.h).
find "$folder" -name '*.csv' | LC_ALL=C sort | xargs cat | awk -F, '
  BEGIN { print "| problem | quantity | resolution | measured | bar | order |"; print "|---|---|---|---|---|---|" }
  { order = $6 == "" ? "" : $7 == "" ? $6 : $6 " (at least " $7 ")"
    print "| " $1 " | " $2 " | " $3 " | " $4 " | " ($5 == "" ? "none" : $5) " | " order " |" }'
