#!/bin/sh
# Builds bench/report/explorer/vendored/ anew from npm, by the lock beside this: one script with what
# the explorer takes of three.js and uPlot, uPlot's style sheet, their licences, and hashes of all.
# Needs node and npm. Users never run it: the result is committed. Usage: build.sh [FOLDER]
set -eu
here=$(cd "$(dirname "$0")" && pwd)
out=$(cd "${1:-$here/../../bench/report/explorer/vendored}" && pwd)

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp "$here/package.json" "$here/package-lock.json" "$here/entry.js" "$work"
cd "$work"
npm ci --silent --no-audit --no-fund --ignore-scripts
version() { node -p "JSON.parse(fs.readFileSync('node_modules/$1/package.json')).version"; }
cp node_modules/three/LICENSE "$out/LICENSE-three.txt"
cp node_modules/uplot/LICENSE "$out/LICENSE-uplot.txt"
{
    echo "/* three.js $(version three), licence:"
    cat node_modules/three/LICENSE
    echo "uPlot $(version uplot), licence:"
    cat node_modules/uplot/LICENSE
    echo "*/"
} >licences.js
npx esbuild entry.js --bundle --minify --format=iife --target=es2020 --legal-comments=none \
    --log-level=warning --outfile=bundle.js
cat licences.js bundle.js >"$out/libraries.min.js"
cp node_modules/uplot/dist/uPlot.min.css "$out/uplot.min.css"
cd "$out"
sha256sum LICENSE-three.txt LICENSE-uplot.txt libraries.min.js uplot.min.css >SHA256SUMS
cat SHA256SUMS
