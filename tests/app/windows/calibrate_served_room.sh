#!/bin/bash
# calibrate_served_room.sh FOLDER: a guided calibration through the wire, on the display with two monitors that two_monitors.sh made:
# `simulate --serve --board` serves two cameras that see a board which a person carries about, with the mistakes that persons make, and the
# light of the second monitor; `calibrate --live` guides it. $PLANLIGHT is the program, $COMPARE compares the rig with the simulator's truth,
# $SEEDS how many rooms (default 1), $FIRST_SEED which is the first, $PRESET of which kind (default paper), $BOARD which board (default
# charuco 10x7 25 mm), $ANSWER the key by which a person at the window keeps (Return) or discards (Delete) the rig (default: no window, it is kept),
# $FORMER a rig.json that is there before. Leaves events-SEED.json, room-SEED/, guided-SEED.json and the window's pictures in FOLDER.
. "$(dirname "$0")/serving.sh"
board=${BOARD:-charuco 10x7 25 mm}
keep=(--headless --keep yes)
[ -z "$ANSWER" ] || command -v xdotool >/dev/null || { echo "skipped: xdotool is not installed"; exit 77; }
press_when_done() {  # PID EVENTS: the key, as soon as the last pose is taken, until the program has taken it; before that it does nothing
  while kill -0 $1 2>/dev/null; do
    if grep -q '"event": *"done"' "$2"; then
      window=$(xdotool search --name "Planlight calibration" | tail -1)
      import -window root -crop 1920x1080+0+0 +repage "$folder/asked.png"
      xdotool windowfocus "$window" key "$ANSWER"
    fi
    sleep 1
  done
}
first=${FIRST_SEED:-1}
for seed in $(seq $first $((first + ${SEEDS:-1} - 1))); do
  room="$folder/room-$seed"
  rm -rf "$room" "$folder"/{events,guided,errors,shots}-$seed*
  serve "$room" --board "$board" --preset ${PRESET:-paper} --seed $seed
  # Of the lamp 25 ms, and what software OpenGL takes to paint.
  echo '{"format": "planlight projector", "version": 1, "made_on": "2024-01-01", "source": "set by the test", "projector": {}, "findings": [], "latency": {"light_delay_ms": 75}}' >"$folder/projector.json"
  name_projector_file "$room/room.json"
  [ -z "$FORMER" ] || cp "$FORMER" "$folder/guided-$seed.json"
  began=$(date +%s.%N)
  [ -z "$ANSWER" ] || keep=(--operator DUMMY0 --keep ask --screenshots "$folder/shots-$seed")
  timeout ${GUIDED_SECONDS:-400} "$PLANLIGHT" calibrate --live --room "$room/room.json" --board "$board" "${keep[@]}" --json --out "$folder/guided-$seed.json" >"$folder/events-$seed.json" 2>"$folder/errors-$seed" & guided=$!
  [ -z "$ANSWER" ] || press_when_done $guided "$folder/events-$seed.json"
  wait $guided; code=$?
  took=$(awk "BEGIN { print $(date +%s.%N) - $began }")
  check "seed $seed: a rig is found" "$(is "$code == 0")" "exit code $code: $(tail -3 "$folder/errors-$seed")"
  if [ "$ANSWER" = Delete ]; then
    check "seed $seed: a rig that is discarded is not written" "$(is "$(grep -c '"rig": *""' "$folder/events-$seed.json") == 1")" "$(tail -c 300 "$folder/events-$seed.json")"
    if [ -n "$FORMER" ]; then cmp -s "$FORMER" "$folder/guided-$seed.json"; else [ ! -e "$folder/guided-$seed.json" ]; fi
    check "seed $seed: and what was there before stays" "$(is "$? == 0")" "$(ls "$folder")"
    [ $code = 0 ] || failed=1
  else
    if [ -n "$FORMER" ]; then cmp -s "$FORMER" "$folder/guided-$seed-before.json"; check "seed $seed: the former rig is kept beside the new one" "$(is "$? == 0")" "$(ls "$folder")"; fi
    [ $code = 0 ] && "$COMPARE" "$folder/guided-$seed.json" "$room/truth.json" "$folder/events-$seed.json" $took || failed=1
  fi
  stop_serving
  tail -2 "$folder/served"
done
exit $failed
