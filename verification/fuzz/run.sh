#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# run.sh NAME SECONDS [FOLDER]: runs build/fuzz/bin/fuzz_NAME for that long, new inputs in
# FOLDER (default out/fuzz/NAME), starting from the corpus of the repository. Ends with 1 at
# the first finding. fuzz_trajectory is started again where HDF5 itself has crashed.
set -uo pipefail
cd "$(dirname "$0")/../.."
name=$1 seconds=$2 folder=${3:-out/fuzz/$1}
mkdir -p "$folder/corpus" "$folder/hdf5"
folder=$(realpath "$folder")
seeds=$PWD/verification/fuzz/corpus/$name program=$PWD/build/fuzz/bin/fuzz_$name
options=(-timeout=20 -rss_limit_mb=2000 -print_final_stats=1 "-artifact_prefix=$folder/")
dictionary=$PWD/verification/fuzz/dictionaries/$name.dict
[ -f "$dictionary" ] && options+=("-dict=$dictionary")
[ "$name" = trajectory ] && options+=(-max_len=128 -malloc_limit_mb=2000000000)
end=$(($(date +%s) + seconds)) crashes=0 status=0
: >"$folder/log"
cd "$folder/hdf5"
while left=$((end - $(date +%s))) && [ "$left" -gt 0 ]; do
  "$program" "${options[@]}" -max_total_time="$left" ../corpus "$seeds" >>"$folder/log" 2>&1
  status=$?
  [ "$status" -eq 77 ] || break
  crashes=$((crashes + 1))
done
runs=$(grep -Eo '^#[0-9]+' "$folder/log" | awk -F'#' '{ if ($2 + 0 < last) sum += last; last = $2 + 0 } END { print sum + last }')
coverage=$(grep -Eo 'cov: [0-9]+' "$folder/log" | tail -1)
echo "fuzz_$name: $runs runs or more, $coverage, $crashes crashes inside HDF5, status $status"
[ "$status" -eq 0 ] || [ "$status" -eq 77 ]
