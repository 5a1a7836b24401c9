#!/bin/sh
# Prints the Python that the house is set up with: 3.11 or newer, able to make environments.
# 3.11 to 3.13 first, since the locks are tried on those.
set -u

at_least='import sys; sys.exit(not (3, 11) <= sys.version_info < (3, int(sys.argv[1])))'

for newest in 14 99; do
    for python in python3 python3.13 python3.12 python3.11 python3.14 python3.15 python; do
        if "$python" -c "$at_least" "$newest" >/dev/null 2>&1; then
            if ! "$python" -c 'import ensurepip, venv' >/dev/null 2>&1; then
                unable=${unable:-$python}
                continue
            fi
            command -v "$python"
            exit 0
        fi
    done
done

if [ -n "${unable:-}" ]; then
    version=$("$unable" -c 'import sys; print("%d.%d" % sys.version_info[:2])')
    echo "expected a Python that can make environments, got $unable without ensurepip;" \
        "install it (Debian, Ubuntu: apt-get install python$version-venv) and run this again" >&2
else
    echo "expected Python 3.11 or newer on the path, got" \
        "$(python3 --version 2>/dev/null || echo 'no python3');" \
        "install one (python.org, or your system's packages) and run this again" >&2
fi
exit 2
