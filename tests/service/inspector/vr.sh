# The tests of Enter VR, where node, Chromium and the built page are: vr.sh SCRIPT BUILD
if ! command -v node >/dev/null; then
  echo "skipped: there is no node here (Debian: nodejs)"
elif [ ! -d "$(dirname "$0")/../../../service/inspector/node_modules" ]; then
  echo "skipped: the page's npm packages are not installed; ./forewalk.sh inspector installs them"
elif [ ! -f "$2/wasm/service/wasm/package/forewalk_core.js" ] || [ ! -f "$2/inspector/buildings/museum.fwmesh" ]; then
  echo "skipped: there is no WebAssembly library under $2; ./forewalk.sh inspector builds it"
elif [ "$1" = vr.mjs ] && [ ! -x /usr/bin/chromium ]; then
  echo "skipped: there is no /usr/bin/chromium here (Debian: chromium)"
elif [ "$1" = vr.mjs ] && [ ! -f "$2/inspector/page/index.html" ]; then
  echo "skipped: the page is not built; ./forewalk.sh inspector builds it"
else
  exec node "$(dirname "$0")/$1" "$2"
fi
