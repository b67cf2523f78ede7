#!/bin/bash
# calibrate_served_room.sh FOLDER: a guided calibration through the wire, on the display with two monitors that two_monitors.sh made:
# `simulate --serve --board` serves two cameras that see a board which a person carries about, with the mistakes that persons make, and the
# light of the second monitor; `calibrate --live` guides it. $PLANLIGHT is the program, $COMPARE compares the rig with the simulator's truth,
# $SEEDS how many rooms (default 1), $FIRST_SEED which is the first, $PRESET of which kind (default paper). Leaves events-SEED.json, room-SEED/ and guided-SEED.json in FOLDER.
folder=$1
ip address add 127.0.0.2/8 dev lo 2>/dev/null
failed=0
check() { if [ "$2" = 1 ]; then echo "ok   $1"; else echo "FAIL $1 ($3)"; failed=1; fi; }
number() { awk "BEGIN { print ($1) ? 1 : 0 }"; }
rm -f "$folder/served"
trap '[ -z "$served" ] || { kill $served 2>/dev/null; wait $served 2>/dev/null; }' EXIT
first=${FIRST_SEED:-1}
for seed in $(seq $first $((first + ${SEEDS:-1} - 1))); do
  room="$folder/room-$seed"
  rm -rf "$room" "$folder"/{events,guided,errors}-$seed*
  "$PLANLIGHT" simulate --board "charuco 10x7 25 mm" --preset ${PRESET:-paper} --seed $seed --serve DUMMY1 --out "$room" >"$folder/served" 2>&1 & served=$!
  for i in $(seq 300); do grep -q "cameras answer" "$folder/served" && break; kill -0 $served 2>/dev/null || break; sleep 0.1; done
  grep -q "cameras answer" "$folder/served" || { echo "skipped: $(cat "$folder/served")"; exit 77; }
  # Of the lamp 25 ms, and what software OpenGL takes to paint.
  echo '{"format": "planlight projector", "version": 1, "made_on": "2024-01-01", "source": "set by the test", "projector": {}, "findings": [], "latency": {"light_delay_ms": 75}}' >"$folder/projector.json"
  sed -i 's|"monitor": "DUMMY1"|"monitor": "DUMMY1", "file": "'"$folder"'/projector.json"|' "$room/room.json"
  began=$(date +%s.%N)
  timeout 400 "$PLANLIGHT" calibrate --live --room "$room/room.json" --board "charuco 10x7 25 mm" --headless --keep yes --json --out "$folder/guided-$seed.json" >"$folder/events-$seed.json" 2>"$folder/errors-$seed"; code=$?
  took=$(awk "BEGIN { print $(date +%s.%N) - $began }")
  check "seed $seed: a rig is found" "$(number "$code == 0")" "exit code $code: $(tail -3 "$folder/errors-$seed")"
  [ $code = 0 ] && "$COMPARE" "$folder/guided-$seed.json" "$room/truth.json" "$folder/events-$seed.json" $took || failed=1
  kill $served; wait $served 2>/dev/null; served=
  tail -2 "$folder/served"
done
exit $failed
