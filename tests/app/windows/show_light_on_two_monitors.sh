#!/bin/bash
# show_light_on_two_monitors.sh FOLDER: `planlight projector --show` on the display with two monitors that two_monitors.sh made: the flashes
# are on the second monitor and only there, the orders are written with their times, all is dark after the end. $PLANLIGHT is the program.
folder=$1
failed=0
check() { if [ "$2" = 1 ]; then echo "ok   $1"; else echo "FAIL $1 ($3)"; failed=1; fi; }
brightest() { convert "$folder/$1.png" -crop "$2" +repage -format '%[fx:maxima]' info:; }
rm -rf "$folder/shown" "$folder"/*.png
"$PLANLIGHT" projector --show --monitor DUMMY0 --keep "$folder/shown" 2>"$folder/errors"
check "the primary monitor is refused" "$([ $? = 5 ] && echo 1)" "$(cat "$folder/errors")"
"$PLANLIGHT" projector --show --monitor DUMMY1 --part latency --frames-hz 60 --configured-ms 40 --keep "$folder/shown" >/dev/null 2>"$folder/errors" & shown=$!
trap 'kill $shown 2>/dev/null' EXIT
white=0
for i in $(seq 30); do
  sleep 0.2
  import -window root "$folder/during.png" || break
  [ "$(brightest during 1024x768+1920+0)" = 1 ] && white=1
  [ "$(brightest during 1920x1080+0+0)" = 0 ] || { white=leak; break; }
  kill -0 $shown 2>/dev/null || break
done
wait $shown; code=$?
import -window root "$folder/after.png"
check "white is seen on the second monitor, never on the first" "$white" "$white"
check "it ends by itself without a fault" "$([ $code = 0 ] && echo 1)" "exit code $code: $(cat "$folder/errors")"
check "dark after the end" "$([ "$(brightest after 1024x768+1920+0)" = 0 ] && echo 1)" "$(brightest after 1024x768+1920+0)"
orders=$(grep -c '"at_ns"' "$folder/shown/latency/light.json") promised=$(grep -c '"promised_ns"' "$folder/shown/latency/light.json")
check "every order is written, and what was promised of it" "$([ "$orders" -gt 60 ] && [ "$promised" = $((orders - 1)) ] && echo 1)" "$orders $promised"
exit $failed
