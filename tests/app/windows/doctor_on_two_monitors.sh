#!/bin/bash
# doctor_on_two_monitors.sh FOLDER: the doctor's page on the display with two monitors that two_monitors.sh made, in a recorded room whose
# projector is the second monitor: the same lines as without a window, its keys, and dark on every way out. $PLANLIGHT is the program. Leaves
# screenshots in FOLDER.
folder=$1
command -v xdotool >/dev/null || { echo "skipped: xdotool is not installed"; exit 77; }
. "$(dirname "$0")/recorded_room.sh"
recorded_room "$folder"
brightest() { import -window root -crop 800x600+1920+0 +repage -colorspace Gray -format '%[fx:round(255*maxima)]' info:; }
lit() { for i in $(seq 150); do [ "$(brightest)" = 255 ] && return 0; sleep 0.1; done; return 1; }
stays_dark() {  # within so many tenths of a second, and for a second from then on
  for i in $(seq "$1"); do [ "$(brightest)" = 0 ] && break; sleep 0.1; done
  for i in 1 2 3 4 5; do [ "$(brightest)" = 0 ] || return 1; sleep 0.2; done
}
open_page() { "$PLANLIGHT" doctor --room "$folder/room.json" --window >"$folder/said.txt" 2>"$folder/errors" & page=$!; }
press() { window=$(xdotool search --name "Planlight doctor" | tail -1); xdotool windowfocus "$window" key "$1"; }
subjects() { grep -E '^(good|look|STOP) ' "$1" | sed -E 's/^[^ ]+ +//; s/  .*//' | grep -v ', focus'; }  # of that there is a line where light is seen

"$PLANLIGHT" doctor --room "$folder/room.json" >"$folder/plain.txt" 2>"$folder/errors"; without=$?
for size in "" "--language de --theme bright"; do
  name=page${size:+-de}
  "$PLANLIGHT" doctor --room "$folder/room.json" --window --screenshot "$folder/$name.png" $size >"$folder/said.txt" 2>"$folder/errors"; code=$?
  check "$name ends with its picture, and the exit code of an examination without a window" "$(is "$code == $without && $code == 6 && $(stat -c %s "$folder/$name.png") > 20000")" "exit code $code, $without: $(cat "$folder/errors")"
  check "the lines of $name are those without a window, in English" "$(is "$(diff <(subjects "$folder/plain.txt") <(subjects "$folder/said.txt") | wc -l) == 0")" "$(diff "$folder/plain.txt" "$folder/said.txt")"
done

open_page
lit; check "the scan's light stands on the second monitor" "$(is "$? == 0")" "$(cat "$folder/errors")"
import -window root -crop 1920x1080+0+0 +repage "$folder/looking.png"
press space
stays_dark 5; check "Space makes it dark, and it stays so" "$(is "$? == 0")" "grey $(brightest)"
check "the page stays open" "$(is "$(kill -0 $page 2>/dev/null; echo $?) == 0")" "$(cat "$folder/errors")"
import -window root -crop 1920x1080+0+0 +repage "$folder/ended.png"
# What was begun without light (cameras that are opened) ends first: until then Enter does nothing, and a person presses it again.
for i in $(seq 15); do press Return; for j in $(seq 10); do [ "$(brightest)" = 255 ] && break 2; sleep 0.1; done; done
lit; check "Enter looks again" "$(is "$? == 0")" "$(cat "$folder/errors")"
press q; wait $page; code=$?
check "Q closes it while it looks: exit code 6" "$(is "$code == 6")" "exit code $code"
stays_dark 5; check "and it is dark" "$(is "$? == 0")" "grey $(brightest)"
for signal in TERM KILL STOP; do
  open_page
  lit; check "the light stands there again" "$(is "$? == 0")" "$(cat "$folder/errors")"
  kill -$signal $page
  stays_dark 20; check "dark after SIG$signal" "$(is "$? == 0")" "grey $(brightest)"
  [ $signal = STOP ] && kill -KILL $page
  wait $page 2>/dev/null
done
exit $failed
