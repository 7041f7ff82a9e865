# agreement.mjs, where there is a package and a node to run it: agreement.sh PACKAGE NATIVE_WALK FOLDER
if [ ! -f "$1/forewalk_core.js" ]; then
  echo "skipped: $1 is not built; ./forewalk.sh wasm builds it"
elif ! command -v node >/dev/null; then
  echo "skipped: there is no node here (Debian: nodejs)"
else
  exec node --expose-gc "$(dirname "$0")/agreement.mjs" "$@"
fi
