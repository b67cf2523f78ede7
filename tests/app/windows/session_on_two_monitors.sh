#!/bin/bash
# session_on_two_monitors.sh FOLDER: the live session on the example patient, on the display with two monitors that
# two_monitors.sh made: the light is on the second monitor and only there, dark before the first pattern and after the end.
# $PLANLIGHT is the program, $PLAN the plan. Leaves screenshots in FOLDER.
folder=$1 patient=/usr/share/doc/invesalius-examples/examples/Cranium.inv3
[ -e $patient ] || { echo "skipped: the package invesalius-examples is not installed"; exit 77; }
failed=0
check() { if [ "$2" = 1 ]; then echo "ok   $1"; else echo "FAIL $1 ($3)"; failed=1; fi; }
number() { awk "BEGIN { print ($1) ? 1 : 0 }"; }
brightest() { convert "$folder/$1.png" -crop 800x600+1920+0 +repage -format '%[fx:maxima]' info:; }
rm -rf "$folder/case" "$folder/pictures" "$folder"/*.png
"$PLANLIGHT" prepare $patient --plan "$PLAN" --out "$folder/case" >/dev/null 2>"$folder/errors" || { cat "$folder/errors"; exit 1; }
echo '{"format": "planlight projector", "version": 1, "made_on": "2026", "projector": {"width": 1280, "height": 800}}' >"$folder/other.json"
"$PLANLIGHT" session "$folder/case" --volume $patient --projector DUMMY1 --projector-file "$folder/other.json" 2>"$folder/errors"; code=$?
check "a projector of another resolution than the one measured is refused" "$(number "$code == 6")" "exit code $code: $(cat "$folder/errors")"
cat "$folder/errors"
"$PLANLIGHT" session "$folder/case" --volume $patient --preset paper --projector DUMMY1 --autoplay --speed-mm-s 5 \
  --end-after-s 40 --screenshots "$folder/pictures" 2>"$folder/errors" & session=$!
trap 'kill $session 2>/dev/null' EXIT
for i in $(seq 150); do xdotool search --name Planlight >/dev/null 2>&1 && break; sleep 0.1; done
import -window root "$folder/before.png"
for i in $(seq 400); do
  lights=$(ls "$folder"/pictures/light-*.png 2>/dev/null | tail -1)
  # The plan is there as soon as a stored light holds green, the colour of the osteotomy line.
  if [ -n "$lights" ]; then
    green=$(convert "$lights" -format '%[fx:mean.g-mean.b]' info:)
    [ "$(number "$green > 0.0003")" = 1 ] && break
  fi
  kill -0 $session 2>/dev/null || break
  sleep 0.2
done
sleep 1
lit_pixels() { convert "$folder/$1.png" -crop 800x600+1920+0 +repage -colorspace Gray -threshold 8% -format '%[fx:mean*w*h]' info:; }
# On a busy machine the light may be dark for a moment, for nothing is renewed that hangs, or still a landmark alone.
for i in $(seq 30); do
  import -window root "$folder/during.png"
  [ "$(number "$(lit_pixels during) > 500")" = 1 ] && break
  sleep 0.3
done
wait $session; code=$?
sleep 0.5
import -window root "$folder/after.png"
check "the session ends by itself without a fault" "$(number "$code == 0")" "exit code $code: $(cat "$folder/errors")"
check "dark before the scan" "$(number "$(brightest before) == 0")" "brightest $(brightest before)"
check "light on the second monitor while it projects" "$(number "$(brightest during) > 0.5")" "brightest $(brightest during)"
check "dark after the end" "$(number "$(brightest after) == 0")" "brightest $(brightest after)"
lit=$(lit_pixels during)
check "the light is a drawing: thin lines, not a filled picture" "$(number "$lit > 500 && $lit < 40000")" "$lit lit pixels"
# The first monitor shows the operator window: its upper left corner is what the window itself stored.
last=$(ls "$folder"/pictures/operator-*.png | tail -1)
convert "$folder/during.png" -crop 400x60+0+0 +repage "$folder/corner.png"
convert "$last" -crop 400x60+0+0 +repage "$folder/corner_stored.png"
same=$(compare -metric RMSE "$folder/corner.png" "$folder/corner_stored.png" null: 2>&1 | sed 's/.*(\(.*\))/\1/')
check "the operator window, and nothing of the light, on the first monitor" "$(number "$same < 0.02")" "difference $same"
exit $failed
