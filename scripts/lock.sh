#!/bin/sh
# Pins every dependency of pyproject.toml, with hashes, for CPython 3.11 and later on any platform:
# requirements.lock to run, requirements-dev.lock to test; and for CPython 3.11 alone, which bpy is
# made for, requirements-oracle.lock (`make oracle`, `make speed`); and on top of the tests' own
# requirements-judges.lock (`make judges`), requirements-kinematics.lock (`make kinematics`),
# requirements-browser.lock (`make browser`) and requirements-cluster.lock (`make cluster-test`); and
# on top of what runs requirements-docs.lock (`make docs`).
# Takes uv from the path, or gets it.
set -eu
cd "$(dirname "$0")/.."

uv=$(command -v uv || true)
if [ -z "$uv" ]; then
    [ -x .venv-lock/bin/uv ] || {
        "$(scripts/find_python.sh)" -m venv .venv-lock
        .venv-lock/bin/python -m pip install -qq --disable-pip-version-check uv
    }
    uv=.venv-lock/bin/uv
fi

trap 'rm -f requirements.lock.part requirements-dev.lock.part requirements-oracle.lock.part \
    requirements-judges.lock.part requirements-kinematics.lock.part requirements-browser.lock.part \
    requirements-cluster.lock.part requirements-docs.lock.part' EXIT

compile() { # OUTPUT [OPTION...]; setuptools builds the house itself, so it is pinned too
    output=$1
    shift
    {
        echo "# Made by 'make lock' from pyproject.toml; change that, not this."
        echo 'setuptools>=77' | "$uv" --no-config pip compile pyproject.toml - \
            --universal --python-version 3.11 --generate-hashes --no-emit-index-url \
            --no-emit-find-links --no-annotate --no-header --quiet "$@"
    } >"$output.part"
    mv "$output.part" "$output"
    echo "wrote $output ($(grep -c '==' "$output") packages)"
}

compile requirements.lock
compile requirements-dev.lock --extra dev --constraint requirements.lock
compile requirements-judges.lock --extra dev --group judges --constraint requirements-dev.lock
compile requirements-kinematics.lock --extra dev --group kinematics --constraint requirements-dev.lock
compile requirements-browser.lock --extra dev --group browser --constraint requirements-dev.lock
compile requirements-cluster.lock --extra dev --group cluster --constraint requirements-dev.lock
compile requirements-docs.lock --group docs --constraint requirements.lock

oracle=requirements-oracle.lock
{
    echo "# Made by 'make lock' from the group 'oracle' of pyproject.toml; change that, not this."
    "$uv" --no-config pip compile --group oracle --universal --python-version 3.11 \
        --generate-hashes --no-emit-index-url --no-emit-find-links --no-annotate --no-header --quiet
} >"$oracle.part"
mv "$oracle.part" "$oracle"
echo "wrote $oracle ($(grep -c '==' "$oracle") packages)"
