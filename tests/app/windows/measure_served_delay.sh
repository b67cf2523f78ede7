#!/bin/bash
# measure_served_delay.sh FOLDER: the delay that `planlight projector` measures through the wire against the one that the served room was
# given, on the display with two monitors that two_monitors.sh made. What the program's own window and the monitor take comes on top of the
# lamp's delay, and is the same whatever the lamp's is. $DELAYS_MS: the settings (default 25 60 95; not a whole number of frames, 40 ms: what comes onto the monitor within an exposure is
# given to the lamp at its end, so that such light would change between exposures only). $PLANLIGHT is the program, $PLAN the plan.
folder=$1 patient=/usr/share/doc/invesalius-examples/examples/Cranium.inv3
[ -e $patient ] || { echo "skipped: the package invesalius-examples is not installed"; exit 77; }
ip address add 127.0.0.2/8 dev lo 2>/dev/null
failed=0 late=0
trap '[ -z "$served" ] || { kill $served 2>/dev/null; wait $served 2>/dev/null; }' EXIT
end_serving() {
  kill $served 2>/dev/null; wait $served 2>/dev/null; served=
  [ "$(awk '/could not keep up/ { print (10 * $7 > $1) ? 1 : 0 }' "$folder/served" | tail -1)" = 1 ] && late=1
}
number() { awk -v n="\"$1\":" '$1 == n { print $2 + 0; exit }' "$folder/projector.json"; }
rm -rf "$folder"/{room,served,errors,projector.json,delays}
echo "lamp's delay ms | measured, median +- one sigma ms | beyond the lamp's ms"
for delay in ${DELAYS_MS:-25 60 95}; do
  "$PLANLIGHT" simulate $patient --plan "$PLAN" --preset paper --seed 1 --projector-delay-ms $delay --serve DUMMY1 --out "$folder/room" >"$folder/served" 2>&1 & served=$!
  for i in $(seq 600); do grep -q "cameras answer" "$folder/served" && break; kill -0 $served 2>/dev/null || break; sleep 0.1; done
  grep -q "cameras answer" "$folder/served" || { echo "skipped: $(cat "$folder/served")"; exit 77; }
  if ! "$PLANLIGHT" projector --room "$folder/room/room.json" --part latency --refresh-hz 60 --out "$folder/projector.json" >/dev/null 2>"$folder/errors"; then
    echo "FAIL at $delay ms: $(tail -1 "$folder/errors")"; failed=1; end_serving; continue
  fi
  awk -v set=$delay -v found=$(number median_ms) -v sigma=$(number median_sigma_ms) \
    'BEGIN { printf "%15g | %23.1f +- %.1f | %.1f\n", set, found, sigma, found - set; print found - set >>"'"$folder"'/delays" }'
  end_serving
done
awk '{ v[NR] = $1; sum += $1 } END { for (i in v) { d = v[i] - sum / NR; if (d < 0) d = -d; if (d > most) most = d }
  printf "%s each is within %.1f ms of the one set and the %.1f ms of window and monitor (3 ms at most)\n", (most <= 3) ? "ok  " : "FAIL", most, sum / NR
  exit most > 3 }' "$folder/delays" || failed=1
if [ $late = 1 ] && [ $failed = 1 ]; then echo "skipped: this machine is too busy to serve the room in time"; exit 77; fi
exit $failed
