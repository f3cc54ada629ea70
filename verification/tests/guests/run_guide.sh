#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# run_guide.sh ROOT BUILD PYTHON: runs the commands of docs/guests.md as they stand, in a
# folder that looks like the repository after ./run build. The part about C++ is left to
# the test of the installed package, which does the same.
set -euo pipefail
root=$1 build=$2 python=$3
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
ln -s "$root"/{examples,firn,scenes} .
mkdir -p build .venv/bin
ln -s "$build" build/release
printf '#!/bin/sh\nexec "%s" "$@"\n' "$python" >.venv/bin/python
chmod +x .venv/bin/python

awk '/^## /{cpp = /C\+\+/} /^```/{inside = /^```sh/ && !cpp; next} inside' "$root/docs/guests.md" >commands
count=0
while read -r command; do
  echo "\$ $command"
  # In a shell of its own: `!` in front of a command does not end a script, so ask for the status.
  bash -c "$command" </dev/null || { echo "failed: $command"; exit 1; }
  count=$((count + 1))
done <commands
echo "$count commands"
[ "$count" -ge 15 ]
