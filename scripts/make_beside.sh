#!/bin/sh
# Makes an environment of the tests' own and, beside it, packages that check us and that no user has
# to pay for: readers of exported datasets (`make judges`), another arm's kinematics (`make
# kinematics`), a driver of browsers (`make browser`), a Dask cluster (`make cluster-test`).
# Usage: make_beside.sh FOLDER LOCK WHAT
set -eu
cd "$(dirname "$0")/.."

folder=$1
lock=$2

cmp -s "$lock" "$folder/.installed" && exit 0
echo "making $folder: $3 to fetch"
.venv/bin/python -m venv --clear "$folder"
pip="$folder/bin/python -m pip -qq --disable-pip-version-check"
$pip install --no-compile --require-hashes --requirement "$lock"
$pip install --no-deps --no-build-isolation --editable .
cp "$lock" "$folder/.installed"
