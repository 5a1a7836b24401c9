#!/bin/sh
# Makes a virtual environment where there is none that works: it may be missing, half made by a
# set-up that was interrupted, or left without its Python by an upgrade of the system.
# Usage: make_environment.sh FOLDER
set -eu

"$1/bin/python" -m pip --version >/dev/null 2>&1 && exit 0
python=$("$(dirname "$0")/find_python.sh")
echo "making $1 with $python ($("$python" --version))"
"$python" -m venv --clear "$1"
