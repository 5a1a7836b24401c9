#!/bin/sh
# Makes .venv-judges: the tests' own environment and, beside it, readers of exported datasets that
# are not ours (pycocotools, webdataset, datasets, mlcroissant, ...), which no user has to pay for.
# Usage: make_judges.sh FOLDER
set -eu
cd "$(dirname "$0")/.."

folder=${1:-.venv-judges}
lock=requirements-judges.lock

cmp -s "$lock" "$folder/.installed" && exit 0
echo "making $folder: readers of exported datasets, 150 MB to fetch"
.venv/bin/python -m venv --clear "$folder"
pip="$folder/bin/python -m pip -qq --disable-pip-version-check"
$pip install --no-compile --require-hashes --requirement "$lock"
$pip install --no-deps --no-build-isolation --editable .
cp "$lock" "$folder/.installed"
