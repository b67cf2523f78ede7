#!/bin/bash
# keep_monitors_on.sh PROGRAM FOLDER SAVER_STATE: a screen saver that begins after two seconds waits while the operator
# window is open, and begins again after it, also when the program was killed. Exit code 77: the tools are not installed.
program=$1 folder=$2 saver=$3 failed=0
for needed in xvfb-run xset; do command -v $needed >/dev/null || { echo "skipped: $needed is not installed"; exit 77; }; done
if [ "$4" != inside ]; then
  rm -rf "$folder"; mkdir -p "$folder"
  LIBGL_ALWAYS_SOFTWARE=1 exec xvfb-run -a -s "-noreset -screen 0 1920x1080x24" "$0" "$program" "$folder" "$saver" inside
fi

becomes() {  # becomes STATE: within ten seconds
  for i in $(seq 50); do [ "$("$saver")" = "$1" ] && return 0; sleep 0.2; done
  return 1
}
check() { if [ "$2" = 0 ]; then echo "ok   $1"; else echo "FAIL $1"; failed=1; fi; }

xset s 2 2
becomes on || { echo "skipped: this display has no screen saver"; exit 77; }
"$program" "$folder" >"$folder/said" 2>"$folder/errors" & pid=$!
trap 'kill -9 $pid 2>/dev/null' EXIT
for i in $(seq 100); do [ -e "$folder/views" ] && break; kill -0 $pid 2>/dev/null || break; sleep 0.2; done
[ -e "$folder/views" ] || { echo "FAIL the window did not open"; cat "$folder/errors"; exit 1; }
[ "$("$saver")" = off ]; check "the window ends the saver" $?
sleep 6
[ "$("$saver")" = off ]; check "and keeps it away, untouched for three times as long as it waits" $?
xset q | grep -q "timeout:  2 "; check "the settings of the desktop are what they were" $?
kill -9 $pid; wait $pid 2>/dev/null
becomes on; check "without the window it begins again" $?
exit $failed
