#!/bin/bash
# press_review.sh PROGRAM FOLDER: presses every control of the window of a review with a real mouse and keyboard
# (xdotool) on a virtual screen and compares what it wanted. Exit code 77: the tools are not installed.
. "$(dirname "$0")/pressing.sh"
open_window 120 places "Planlight press review"

place() { awk -v n="$1" -v u="$2" -v v="$3" '$1 == n { printf "%d %d\n", $2 + u * $4, $3 + v * $5 }' "$folder/places"; }  # at a share of its width and height

grep -vE '^(left|right|head|time-line) ' "$folder/places" >"$folder/buttons"
large_enough "$folder/buttons"
silent "nothing is wanted of itself"
for pair in Left:"frame before" Right:"frame after" Up:"event before" Down:"event after" Prior:"event before" Next:"event after" Home:begin End:end; do
  xdotool key "${pair%%:*}"; wait_for "${pair#*:}" "the key ${pair%%:*}"
done
xdotool key Right Right Right; sleep 1
[ "$(since | grep -c "frame after")" = 3 ] && echo "ok   three presses at once are three" || { echo "FAIL three presses at once"; failed=1; }
looked
for pair in Beginning:begin Event-before:"event before" Frame-before:"frame before" Frame-after:"frame after" Event-after:"event after" End:end; do
  click $(place "${pair%%:*}" 0.5 0.5); wait_for "${pair#*:}" "the button ${pair%%:*}"
done
# The plot of 100 s has margins at its left and right.
click $(place time-line 0.5 0.5); wait_for "to time \(4[6-9]\|50\)" "a press on the time line goes there"
xdotool mousemove $(place time-line 0.3 0.4); sleep 0.2; xdotool mousedown 1; sleep 0.2
xdotool mousemove $(place time-line 0.5 0.4); sleep 0.3; xdotool mousemove $(place time-line 1.1 0.4); sleep 0.3; xdotool mouseup 1
wait_for "to time 100" "and dragging goes on to its end"
xdotool mousemove $(place time-line 0.5 0.5); sleep 0.2; xdotool click 5; wait_for "frame after" "the wheel over it steps on"
xdotool click 4; wait_for "frame before" "and back"
# Round the plan: 120x120 pixels from (140, 90); its corners stand at pixels (160, 110) and so on, a sixth from the edges of a square.
middle() { awk -v n="$1" -v u="$2" -v v="$3" '$1 == n { s = $4 < $5 ? $4 : $5; printf "%d %d\n", $2 + $4 / 2 + u * s, $3 + $5 / 2 + v * s }' "$folder/places"; }
click $(middle left 0.34 -0.32); wait_for "pick 2" "a press on the plan in the left picture picks that place"
click $(middle right -0.32 0.34); wait_for "pick 4" "and in the right one"
xdotool key z; sleep 0.5; click $(middle left 0.34 -0.32); silent "in the whole picture the plan is not there"
click $(place Whole-picture 0.5 0.5); sleep 0.5; click $(middle left 0.34 -0.32); wait_for "pick 2" "and round the plan it is again"
click $(place head 0.5 0.5); wait_for "pick [0-9]*" "a press on the plan on the head picks a place"
click $(place head 0.5 0.9); silent "beside the plan nothing is picked on the head"
xdotool key v; sleep 0.5; click $(place head 0.5 0.5); silent "in the projector's picture nothing is picked"
xdotool key v; sleep 0.5; click $(place head 0.5 0.5); wait_for "pick [0-9]*" "and on the head again"
xdotool key s; wait_for snapshot "a picture of the window by its key"
xdotool key x; silent "another key says nothing"
xdotool key q; wait_for quit "to close"
exit $failed
