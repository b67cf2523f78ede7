#!/bin/bash
# operate_served_room.sh FOLDER: as a person would, on the display with two monitors that two_monitors.sh made: the room served
# as hardware by `simulate --serve`, its devices listed, captured and checked, the projector's delay measured, and a session in
# it, each by the program's own command. $PLANLIGHT is the program, $PLAN the plan. Leaves screenshots in FOLDER.
. "$(dirname "$0")/serving.sh"
rm -rf "$folder"/{case,room,capture,pictures,errors,room.json,projector.json}
prepare_case
serve_patient "$folder/room" 1
"$PLANLIGHT" devices --out "$folder/room.json" >"$folder/devices" 2>&1
check "both cameras and both monitors are listed" "$(grep -c -e SIM-L -e SIM-R -e DUMMY0 -e DUMMY1 "$folder/devices" | awk '{print ($1 >= 4) ? 1 : 0}')" "$(cat "$folder/devices")"
check "a first room.json names them" "$(grep -c -e SIM-L -e SIM-R -e DUMMY1 "$folder/room.json" | awk '{print ($1 >= 3) ? 1 : 0}')" "$(cat "$folder/room.json")"
measure_delay; code=$?
check "the projector's delay is measured through the wire" "$(is "$code == 0")" "exit code $code: $(cat "$folder/errors")"
cat "$folder/latency"
name_projector_file "$folder/room/room.json"
"$PLANLIGHT" capture --room "$folder/room/room.json" --out "$folder/capture" 2>"$folder/errors"; code=$?
check "a scan is captured" "$(is "$code == 0")" "exit code $code: $(cat "$folder/errors")"
"$PLANLIGHT" check "$folder/capture" --rig "$folder/room/rig.json" >"$folder/checked" 2>&1; code=$?
check "the rig is good by it" "$(is "$code == 0")" "exit code $code: $(cat "$folder/checked")"
"$PLANLIGHT" session "$folder/case" --room "$folder/room/room.json" --operator DUMMY0 --autoplay --record all --json --end-after-s ${TRACK_S:-10} \
  --screenshots "$folder/pictures" >"$folder/latency.json" 2>"$folder/errors" & session=$!
for i in $(seq 600); do
  kill -0 $session 2>/dev/null || break
  [ "$(ls "$folder"/pictures/operator-*.png 2>/dev/null | wc -l)" -ge 6 ] && import -window root "$folder/during.png"
  sleep 0.2
done
wait $session; code=$?; session=
check "the session ends by itself without a fault" "$(is "$code == 0")" "exit code $code: $(cat "$folder/errors")"
grep -v histogram "$folder/latency.json"; grep -o '^.*worst_ms": [0-9.]*' "$folder/latency.json"
check "it came to the light" "$(ls "$folder"/pictures/light-*.png 2>/dev/null | wc -l | awk '{print ($1 > 0) ? 1 : 0}')" "no light"
stop_serving
"$PLANLIGHT" replay "$folder"/case/recordings/*.plrec --json >"$folder/replayed" 2>"$folder/errors"; code=$?
updates=$(awk -F'[:,]' '/"updates"/ {print $2}' "$folder/replayed")
whole=$(grep -c '"whole": true' "$folder/replayed")
check "its recording is replayed to its end, to the last digit" "$(is "$code == 0 && $whole == 1 && ${updates:-0} > 0")" \
  "exit code $code, whole: $whole, updates: $updates: $(cat "$folder/errors")"
grep -e scans -e updates -e decisions -e ended "$folder/replayed"
"$PLANLIGHT" report "$folder"/case/recordings/*.plrec --out "$folder/operation.html" 2>"$folder/errors"; code=$?
check "its report is written" "$(is "$code == 0")" "exit code $code: $(cat "$folder/errors")"
end
