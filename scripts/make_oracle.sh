#!/bin/sh
# Makes .venv-oracle, where Blender Cycles lives (`bpy` from PyPI), apart from the house's own
# environment: bpy needs one very Python and an older numpy. Where bpy misses libraries of the
# system, gets them as root on Debian or Ubuntu, else says which.
# Usage: make_oracle.sh FOLDER
set -eu
cd "$(dirname "$0")/.."

folder=${1:-.venv-oracle}
lock=requirements-oracle.lock
wanted=3.11 # what the wheel of the pinned bpy is made for
libraries="libgl1 libice6 libsm6 libx11-6 libxext6 libxfixes3 libxi6 libxkbcommon0 libxrender1"

loads() { "$folder/bin/python" -c 'import bpy' >/dev/null 2>&1; }

is_wanted() {
    "$1" -c 'import sys; sys.exit("%d.%d" % sys.version_info[:2] != sys.argv[1])' $wanted \
        >/dev/null 2>&1
}

if ! cmp -s "$lock" "$folder/.installed" || ! is_wanted "$folder/bin/python"; then
    for python in .venv/bin/python python$wanted python3 ""; do
        [ -n "$python" ] || {
            echo "expected Python $wanted on the path, for which bpy is made, got none;" \
                "install it (pyenv install $wanted; uv python install $wanted) and run this again" >&2
            exit 2
        }
        if is_wanted "$python"; then break; fi
    done
    echo "making $folder with $python: Blender Cycles, 370 MB to fetch"
    "$python" -m venv --clear "$folder"
    "$folder/bin/python" -m pip -qq --disable-pip-version-check \
        install --require-hashes --requirement "$lock"
    cp "$lock" "$folder/.installed"
fi

loads && exit 0
if command -v apt-get >/dev/null 2>&1 && [ "$(id -u)" = 0 ]; then
    echo "Blender: installing $libraries"
    export DEBIAN_FRONTEND=noninteractive
    for attempt in install update-and-install; do
        [ $attempt = install ] || apt-get update >/dev/null 2>&1 || true
        # shellcheck disable=SC2086
        apt-get install --yes --no-install-recommends $libraries >/dev/null 2>&1 || true
        loads && exit 0
    done
fi
echo "expected bpy to load in $folder, got:" >&2
"$folder/bin/python" -c 'import bpy' 2>&1 | tail -n 1 >&2
echo "install the system's libraries that it names (Debian, Ubuntu: apt-get install $libraries)" >&2
exit 2
