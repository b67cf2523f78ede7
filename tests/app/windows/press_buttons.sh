#!/bin/bash
# press_buttons.sh PROGRAM FOLDER: presses every control of the operator window with a real mouse and keyboard (xdotool)
# on a virtual screen and compares what the window said. Exit code 77: the tools are not installed.
. "$(dirname "$0")/pressing.sh"
open_window 200 views "Planlight buttons"

place() { cat "$folder"/{actions,views,view-buttons,landmarks,page,question,whole} 2>/dev/null | awk -v n="$1" '$1 == n { print $2, $3 }'; }

wait_for "drawn 0 and 1 times" "what has not changed is not drawn, what has changed is drawn once"
large_enough "$folder/actions" "$folder/views"
for view in before error after; do click $(place $view); wait_for "view $view" "the view $view"; done
for control in scan register stop dark confirm; do click $(place $control); wait_for $control "pressing $control"; done
click $(place track); wait_for "answer Track is not possible now: is running." "a button that is not enabled says why"
silent "and nothing else"
xdotool mousemove $(place dark); sleep 0.4; xdotool click 1; wait_for dark "DARK by the shortest click"
for key in space b Escape Prior; do xdotool key $key; wait_for dark "DARK by the key $key"; done
busy_with() {  # busy_with PRESS...: what is done while the window is busy with a frame; it takes all of it at once
  local frozen; frozen=$(pgrep -P "$pid")
  kill -STOP "$frozen"; for press in "$@"; do xdotool $press; done; kill -CONT "$frozen"
}
for key in s Return; do
  busy_with "key $key" "key space"; wait_for dark "DARK in a busy window"; silent "and nothing of $key that was pressed before it"
done
busy_with "key b" "key s"; wait_for dark "DARK in a busy window"; silent "and nothing of what was pressed beside it"
xdotool mousemove $(place scan); sleep 0.4
busy_with "mousedown 1" "mouseup 1" "key space"; wait_for dark "DARK in a busy window"; silent "and nothing of a click before it"
busy_with "mousedown 1" "key space" "mouseup 1"; wait_for dark "DARK in a busy window"; silent "and nothing of a click around it"
xdotool mousedown 1; sleep 0.4; xdotool key space; wait_for dark "DARK while a button is held down"
xdotool mouseup 1; silent "and nothing of that button"
click $(place scan); wait_for scan "the next click counts"
for pair in s:scan r:register x:stop c:confirm; do xdotool key ${pair%:*}; wait_for ${pair#*:} "the key ${pair%:*}"; done
for pair in 1:before 3:error 2:after; do xdotool key ${pair%:*}; wait_for "view ${pair#*:}" "the view ${pair#*:} by its key"; done
xdotool key t; wait_for "answer Track is not possible now: is running." "the key of a button that is not enabled says why"
xdotool key k; wait_for "answer The skin is checked while the light follows the patient." "so does one of a button that is not there"
xdotool key z; silent "another key says nothing"
click $(place evidence); wait_for "page open" "the evidence by one press"
for i in $(seq 50); do [ -e "$folder/page" ] && break; sleep 0.2; done
large_enough "$folder/page"
xdotool key c; wait_for "answer There is nothing to say yes to now." "what the page hides is not pressed by its key"
click $(place item-2); wait_for "item 2" "one item of the plan alone"
click $(place hide-1); wait_for "hide 1" "another one hidden"
click $(place item-2); wait_for "show 0" "and the whole plan again, also what was hidden"
click $(place hide-2); wait_for "hide 2" "an item is hidden"
click $(place hide-2); wait_for "show 2" "and shown again"
click $(place close); wait_for "page closed" "and closed"
xdotool key h; wait_for "answer Mark a row of the plan with the arrow keys first; H hides it, or shows it again." "hiding without a row says why"
xdotool key i; wait_for "item 1" "the first item by its key"
xdotool key i; wait_for "item 2" "the next"
xdotool key h; wait_for "hide 2" "the item that was lit is hidden by its key"
xdotool key i; wait_for "item 1" "the first item again"
xdotool key i; wait_for "item 3" "a hidden one is not lit alone"
xdotool key 0; wait_for "show 0" "all of the plan by its key"
xdotool key Up; sleep 0.4; xdotool key Up; sleep 0.4; xdotool key h; wait_for "hide 1" "a row that is marked by the arrow keys"
xdotool key h; wait_for "show 1" "and shown again"
xdotool key h; wait_for "hide 1" "hidden once more"
click $(place all-items); wait_for "show 0" "and all of the plan by its button"
click $(place views); wait_for "view buttons open" "the buttons of the views"
for i in $(seq 50); do [ -e "$folder/view-buttons" ] && break; sleep 0.2; done
large_enough "$folder/view-buttons"
click $(place view-L); wait_for "turned -" "from the patient's left"
click $(place view-R); wait_for "turned +" "from the patient's right"
click $(place view-projector); silent "a view that is not known does nothing"
xdotool key F1; wait_for "turned -" "from the front by its key"
xdotool key F7; wait_for "answer The projector's view is known once the patient is found." "the key of a view that is not known says why"
click $(place view-reset); wait_for "turned +" "as at first"
click $(place views-close); wait_for "view buttons closed" "and closed"
xdotool key e; wait_for "page open" "the evidence by its key"
xdotool key e; wait_for "page closed" "and closed by it"
xdotool mousemove 600 500; sleep 0.4; xdotool mousedown 1; sleep 0.4; xdotool mousemove 700 500; sleep 0.4; xdotool mouseup 1
wait_for "turned +" "dragging the head to the right shows more of the patient's right"
silent "and nothing else happens"

click $(place landmarks); wait_for "landmarks open" "the landmarks"
for i in $(seq 50); do [ -e "$folder/landmarks" ] && break; sleep 0.2; done
large_enough "$folder/landmarks"
read -r skin_x skin_y <<<"$(place skin-view)"; read -r scan_x scan_y <<<"$(place scan-view)"
click $(place use); silent "landmarks are not used before there are three"
n=0
for at in "-40 -60" "45 -50" "5 30"; do
  set -- $at; n=$((n + 1))
  click $((skin_x + $1)) $((skin_y + $2)); silent "a landmark on the skin alone is none"
  click $((scan_x + $1)) $((scan_y + $2)); wait_for "landmarks $n on the head" "landmark $n, where it was clicked"
done
click $(place undo); wait_for "landmarks 2 on the head" "a landmark is taken back"
xdotool key m; wait_for "answer At least 3 landmarks are needed." "the key of landmarks says why they are not used"
xdotool mousemove "$scan_x" "$scan_y"; sleep 0.4; xdotool mousedown 1; sleep 0.4; xdotool mousemove $((scan_x + 60)) "$scan_y"; sleep 0.4; xdotool mouseup 1
silent "dragging the scan is no click"
click "$scan_x" $((scan_y + 30)); wait_for "landmarks 3 on the head" "a landmark on the turned scan"
xdotool key space; wait_for dark "DARK by the key while landmarks are clicked"
xdotool key u; wait_for "landmarks 2 on the head" "a landmark is taken back by its key"
for turn in 1 2 3 4; do xdotool key q; silent "the scan is turned by its key"; done
click "$scan_x" $((scan_y + 30)); wait_for "landmarks 3 on the head" "and clicked again"
xdotool key l; wait_for "landmarks closed" "landmarks are closed by their key"
xdotool key u; wait_for "answer That key is for landmarks, and they are not open." "and then the keys in them say why not"
xdotool key l; wait_for "landmarks open" "and opened by it"
xdotool key m; wait_for "use landmarks" "using three landmarks, by their key"
wait_for "landmarks closed" "which closes them"
click $(place landmarks); wait_for "landmarks open" "opened once more"
click $(place use); wait_for "use landmarks" "using them"
click $(place confirm); wait_for confirm "the 3-D view is back"

touch "$folder/close"; wait_for "question open" "closing the window while light is on asks first"
for i in $(seq 50); do [ -e "$folder/question" ] && break; sleep 0.2; done
large_enough "$folder/question"
xdotool key space; wait_for dark "DARK works while it is asked"
click $(place dark); wait_for dark "and by the mouse"
xdotool key s; silent "another key answers nothing"
xdotool key Next; wait_for "question closed" "to stay, by the pedal that leads on"
touch "$folder/close"; wait_for "question open" "asked once more"
xdotool key Return; wait_for "question closed" "to stay, by Enter"
touch "$folder/close"; wait_for "question open" "and again"
click $(place stay); wait_for "question closed" "to stay"
touch "$folder/close"; wait_for "question open" "asked again"
xdotool key n; wait_for "question closed" "to stay, by its key"
touch "$folder/close"; wait_for "question open" "and again"
xdotool key y; wait_for quit "to close"
exit $failed
