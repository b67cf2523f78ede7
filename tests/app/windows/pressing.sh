# Sourced by the scripts that press a window with a real mouse and keyboard (xdotool) on a virtual screen; each is called
# as SCRIPT PROGRAM FOLDER. Exit code 77: the tools are not installed.
program=$1 folder=$2 failed=0 seen=0
for needed in xvfb-run xdotool; do command -v $needed >/dev/null || { echo "skipped: $needed is not installed"; exit 77; }; done
if [ "$3" != inside ]; then
  rm -rf "$folder"; mkdir -p "$folder"
  LIBGL_ALWAYS_SOFTWARE=1 exec xvfb-run -a -s "-screen 0 1920x1080x24" "$0" "$program" "$folder" inside
fi

open_window() {  # open_window SECONDS FILE TITLE: runs the program until FILE stands in its folder; $window
  timeout "$1" "$program" "$folder" >"$folder/said" 2>"$folder/errors" & pid=$!
  trap 'kill $pid 2>/dev/null' EXIT
  for i in $(seq 100); do [ -e "$folder/$2" ] && break; kill -0 $pid 2>/dev/null || break; sleep 0.2; done
  [ -e "$folder/$2" ] || { echo "FAIL the window did not open"; cat "$folder/errors"; exit 1; }
  window=$(xdotool search --name "$3" | tail -1)
  xdotool windowfocus "$window"; sleep 0.3
}
since() { tail -n +$((seen + 1)) "$folder/said"; }  # what was said since the last look
looked() { seen=$(wc -l <"$folder/said"); }
wait_for() {  # wait_for WORDS WHAT: a line WORDS was said since the last look, which is there: what was said after it is still to be looked at
  for i in $(seq 40); do
    at=$(since | grep -nx -m1 -- "$1" | cut -d: -f1)
    if [ -n "$at" ]; then seen=$((seen + at)); echo "ok   $2"; return; fi
    sleep 0.1
  done
  echo "FAIL $2: \"$1\" was not said, but: $(since | tr '\n' ',')"; failed=1; looked
}
silent() { sleep 1; if [ "$(wc -l <"$folder/said")" != "$seen" ]; then echo "FAIL $1: $(tail -1 "$folder/said")"; failed=1; else echo "ok   $1"; fi; looked; }
click() { xdotool mousemove "$1" "$2"; sleep 0.4; xdotool mousedown 1; sleep 0.4; xdotool mouseup 1; }
large_enough() { awk '$4 < 72 || $5 < 72 { print "FAIL " $1 " is " $4 "x" $5 " pixels, less than 72"; bad = 1 } END { exit bad }' "$@" || failed=1; }
