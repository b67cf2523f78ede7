#!/bin/bash
# cameras_on_two_monitors.sh FOLDER: the page of the cameras on the display with two monitors that two_monitors.sh made, in a recorded room
# whose projector is the second monitor: its test picture stands there pixel by pixel, goes out when the page ends, and when it is
# stopped or killed. $PLANLIGHT is the program. Leaves screenshots in FOLDER.
folder=$1
. "$(dirname "$0")/recorded_room.sh"
recorded_room "$folder"
light() { import -window root -crop 800x600+1920+0 +repage "$folder/$1.png"; }
grey() { convert "$folder/$1.png" -colorspace Gray -depth 8 -format "%[fx:round(255*p{$2,$3}.r)]" info:; }
brightest() { convert "$folder/$1.png" -colorspace Gray -format '%[fx:round(255*maxima)]' info:; }
lit() { for i in $(seq 100); do light "$1"; [ "$(brightest "$1")" = 255 ] && return 0; sleep 0.2; done; return 1; }
dark_within() { for i in $(seq "$2"); do light "$1"; [ "$(brightest "$1")" = 0 ] && return 0; sleep 0.2; done; return 1; }

"$PLANLIGHT" cameras --room "$folder/room.json" --show frame --seconds 6 --screenshot "$folder/page.png" 2>"$folder/errors" & page=$!
lit frame; check "the frame stands on the second monitor" "$(is "$? == 0")" "$(cat "$folder/errors")"
for at in "0 0" "799 0" "0 599" "799 599" "400 0" "0 300" "399 299" "400 300"; do
  check "pixel $at is lit" "$(is "$(grey frame $at) == 255")" "grey $(grey frame $at)"
done
for at in "1 1" "798 598" "200 150"; do check "pixel $at is dark" "$(is "$(grey frame $at) == 0")" "grey $(grey frame $at)"; done
wait $page; code=$?
check "the page ends with its picture" "$(is "$code == 0 && $(stat -c %s "$folder/page.png") > 20000")" "exit code $code"
dark_within after 5; check "then it is dark" "$(is "$? == 0")" "grey $(brightest after)"
for signal in TERM KILL STOP; do
  "$PLANLIGHT" cameras --room "$folder/room.json" --show star 2>"$folder/errors" & page=$!
  lit star; check "the star stands there" "$(is "$? == 0")" "$(cat "$folder/errors")"
  kill -$signal $page
  # A picture expires a second after it was last asked for.
  dark_within "after-$signal" 10; check "dark after SIG$signal" "$(is "$? == 0")" "grey $(brightest "after-$signal")"
  [ $signal = STOP ] && kill -KILL $page
  wait $page 2>/dev/null
done
exit $failed
