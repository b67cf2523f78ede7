#!/bin/bash
# cameras_on_two_monitors.sh FOLDER: the page of the cameras on the display with two monitors that two_monitors.sh made, in a recorded room
# whose projector is the second monitor: its test picture stands there pixel by pixel, goes out when the page ends, and when it is
# stopped or killed. $PLANLIGHT is the program. Leaves screenshots in FOLDER.
folder=$1
failed=0
check() { if [ "$2" = 1 ]; then echo "ok   $1"; else echo "FAIL $1 ($3)"; failed=1; fi; }
is() { awk "BEGIN { print ($1) ? 1 : 0 }"; }
rm -rf "$folder/frames" "$folder"/*.png "$folder"/*.json
mkdir -p "$folder/frames/left" "$folder/frames/right"
list=
for i in 0 1 2 3 4; do
  for side in left right; do convert -size 320x240 -seed $i plasma:grey30-grey70 -colorspace Gray "$folder/frames/$side/$i.png" || exit 77; done
  list="$list${list:+, }{\"picture\": \"$i.png\", \"number\": $i, \"at_ns\": $((i * 40000000)), \"exposure_ns\": 5000000}"
done
echo "{\"format\": \"planlight frames\", \"version\": 1, \"frames\": [$list]}" >"$folder/frames/frames.json"
echo '{"format": "planlight room", "version": 1, "rig": "rig.json", "projector": {"monitor": "DUMMY1"}, "cameras": {"recorded": {"frames": "frames"}}}' >"$folder/room.json"
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
