#!/bin/sh
# Gets the system's Chromium, where this is Debian or Ubuntu and we are root; else says how. Never
# fails: the tests skip, with the reason, where there is none. Usage: ensure_chromium.sh
set -u

command -v chromium >/dev/null 2>&1 || command -v chromium-browser >/dev/null 2>&1 && exit 0
if ! command -v apt-get >/dev/null 2>&1 || [ "$(id -u)" != 0 ]; then
    echo "chromium: none found: install it (sudo apt-get install chromium), then this again"
    exit 0
fi
quietly() { timeout 600 env DEBIAN_FRONTEND=noninteractive "$@" >/dev/null 2>&1 </dev/null; }
echo "chromium: installing"
install="apt-get install --yes --no-install-recommends -o DPkg::Lock::Timeout=60 chromium"
quietly $install || { quietly apt-get update && quietly $install; } ||
    echo "chromium: '$install' failed: run it by hand to see why"
exit 0
