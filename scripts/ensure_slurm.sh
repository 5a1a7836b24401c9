#!/bin/sh
# Gets SLURM and munge, where this is Debian or Ubuntu and we are root; else says how. Never fails:
# the tests skip, with the reason, where there is none. No daemon of theirs is started here.
# Usage: ensure_slurm.sh
set -u

missing=
for program in slurmctld slurmd sbatch munged; do
    PATH=$PATH:/usr/sbin command -v $program >/dev/null 2>&1 || missing=$program
done
[ -z "$missing" ] && exit 0
if ! command -v apt-get >/dev/null 2>&1 || [ "$(id -u)" != 0 ]; then
    echo "SLURM: no $missing found: install it (sudo apt-get install slurm-wlm munge), then this again"
    exit 0
fi
quietly() { timeout 600 env DEBIAN_FRONTEND=noninteractive "$@" >/dev/null 2>&1 </dev/null; }
echo "SLURM: installing"
install="apt-get install --yes --no-install-recommends -o DPkg::Lock::Timeout=60 slurm-wlm munge"
quietly $install || { quietly apt-get update && quietly $install; } ||
    echo "SLURM: '$install' failed: run it by hand to see why"
exit 0
