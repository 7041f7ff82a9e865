# A test of the inspector, where there is a page and a browser to open it: inspector.sh SCRIPT PAGE ARGUMENTS...
script=$1
shift
if [ ! -f "$1/index.html" ]; then
  echo "skipped: $1 is not built; ./forewalk.sh inspector builds it"
elif ! command -v node >/dev/null; then
  echo "skipped: there is no node here (Debian: nodejs)"
elif [ ! -x /usr/bin/chromium ]; then
  echo "skipped: there is no browser here (Debian: chromium)"
elif [ ! -d "$(dirname "$0")/../../../service/inspector/node_modules/playwright-core" ]; then
  echo "skipped: npm's packages are not installed; ./forewalk.sh inspector installs them"
else
  exec node "$(dirname "$0")/$script" "$@"
fi
