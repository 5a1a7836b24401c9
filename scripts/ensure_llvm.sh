#!/bin/sh
# Gets a libLLVM with which the variant llvm_ad_rgb renders, if this machine lacks one and it can:
# as root on Debian or Ubuntu, the distribution's own newest. Else says in one line how, and lets
# the house go on with scalar_rgb. Never fails.
# Usage: ensure_llvm.sh PYTHON, one with Mitsuba installed.
set -u

python=${1:-.venv/bin/python}
probe=$(dirname "$0")/../renders/variant/probe_program.py
oldest=19 # 14, 15 and 16 abort on processors with AVX-512

renders() {
    kernels=$(mktemp -d) || return 1
    DRJIT_CACHE_DIR=$kernels "$python" -P "$probe" llvm_ad_rgb >/dev/null 2>&1
    code=$?
    rm -rf "$kernels"
    return $code
}

newest() { # the newest libllvmN that apt offers, N being $oldest or more
    apt-cache search --names-only '^libllvm[0-9]+$' 2>/dev/null |
        sed -n 's/^libllvm\([0-9]*\) .*/\1/p' | sort -n |
        awk -v oldest=$oldest '$1 >= oldest { found = $1 } END { if (found) print "libllvm" found }'
}

quietly() { timeout 300 env DEBIAN_FRONTEND=noninteractive "$@" >/dev/null 2>&1 </dev/null; }

go_on() {
    echo "LLVM: $1; going on with scalar_rgb, slower but correct"
    exit 0
}

renders && exit 0
[ -z "${DRJIT_LIBLLVM_PATH:-}" ] ||
    go_on "DRJIT_LIBLLVM_PATH is '$DRJIT_LIBLLVM_PATH', which does not render: point it to a libLLVM of $oldest or newer, or unset it"

if ! command -v apt-get >/dev/null 2>&1; then
    go_on "none that renders found: install libLLVM $oldest or newer (dnf install llvm-libs, pacman -S llvm-libs, brew install llvm), and set DRJIT_LIBLLVM_PATH to it if it is not found"
fi
if [ "$(id -u)" != 0 ]; then
    package=$(newest)
    go_on "none that renders found: run 'sudo apt-get install ${package:-libllvm$oldest}', then this again"
fi

package=$(newest)
[ -n "$package" ] || { quietly apt-get update; package=$(newest); }
[ -n "$package" ] ||
    go_on "none that renders found, and apt offers none of $oldest or newer: see https://apt.llvm.org"
echo "LLVM: installing $package"
install="apt-get install --yes --no-install-recommends -o DPkg::Lock::Timeout=60 $package"
quietly $install || { quietly apt-get update && quietly $install; } ||
    go_on "'apt-get install $package' failed: run it by hand to see why"
renders && exit 0
go_on "$package is installed, but llvm_ad_rgb does not render: '$python -P $probe llvm_ad_rgb' says why"
