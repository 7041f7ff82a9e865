#!/usr/bin/env bash
# Follows a page of service/guide word for word: follow.sh PAGE CLONE WORK [NEEDED...]
#
# Blocks of ```sh are run one after another in one shell that begins in CLONE, with HOME an empty folder below WORK. A
# block whose opening names a file (```c walk.c) is written to it where the shell then is. A ```text block is what the
# ```sh block before it prints. Skips where a command NEEDED is missing.
set -euo pipefail
page=$1 clone=$2 work=$3
shift 3
for needed in "$@"; do
  if ! command -v "$needed" >/dev/null && [ ! -e "$needed" ]; then
    echo "skipped: $needed is missing here"
    exit 0
  fi
done
rm -rf "$work"
mkdir -p "$work/home"
export HOME="$work/home"

# The page as a script: what each block prints goes to a file of its own.
awk -v work="$work" '
  /^```/ && !inside {
    inside = 1; language = substr($1, 4); file = $2; ++block
    if (language == "sh") { ran = block; printf "echo \"# block %d\" >&3\n{\n", block }
    else if (language == "text") { printf "" > (work "/expected." ran) }
    else if (file != "") printf "cat > \"%s\" <<\"END_OF_BLOCK\"\n", file
    next
  }
  /^```/ {
    if (language == "sh") printf "} >\"%s/printed.%d\"\n", work, ran
    else if (language != "text" && file != "") print "END_OF_BLOCK"
    inside = 0; next
  }
  inside && language == "text" { print > (work "/expected." ran); next }
  inside && (language == "sh" || file != "") { print }
' "$page" >"$work/script"

cd "$clone"
set +e
(
  set -m
  exec 3>&1
  trap 'for job in $(jobs -p); do kill -- "-$job" 2>/dev/null || true; done' EXIT
  set -e
  . "$work/script"
)
status=$?
set -e
if [ "$status" -ne 0 ]; then
  echo "$page: the block named last ended with an error" >&2
  tail -n 20 "$work"/printed.* >&2
  exit 1
fi

for expected in "$work"/expected.*; do
  diff -u --label "the page says" --label "is printed" "$expected" "$work/printed.${expected##*.}" ||
    { echo "$page: block ${expected##*.} prints something else than the page says" >&2; exit 1; }
done
