#!/bin/bash
# measure_served_delay.sh FOLDER: the delay that `planlight projector` measures through the wire against the one that the served room was
# given, on the display with two monitors that two_monitors.sh made. What the program's own window and the monitor take comes on top of
# the lamp's delay, and is the same whatever the lamp's is. $DELAYS_MS: the settings (default 25 60 95). None should be a whole number of
# frames (40 ms): what comes onto the monitor within an exposure is given to the lamp at its end, so that such light would change between
# exposures only.
. "$(dirname "$0")/serving.sh"
number() { awk -v n="\"$1\":" '$1 == n { print $2 + 0; exit }' "$folder/projector.json"; }
rm -rf "$folder"/{room,served,errors,projector.json,delays}
echo "lamp's delay ms | measured, median +- one sigma ms | beyond the lamp's ms"
for delay in ${DELAYS_MS:-25 60 95}; do
  serve_patient "$folder/room" 1 --projector-delay-ms $delay
  measure_delay || { echo "FAIL at $delay ms: $(tail -1 "$folder/errors")"; failed=1; continue; }
  awk -v set=$delay -v found=$(number median_ms) -v sigma=$(number median_sigma_ms) \
    'BEGIN { printf "%15g | %23.1f +- %.1f | %.1f\n", set, found, sigma, found - set; print found - set >>"'"$folder"'/delays" }'
done
awk '{ v[NR] = $1; sum += $1 } END { for (i in v) { d = v[i] - sum / NR; if (d < 0) d = -d; if (d > most) most = d }
  printf "%s each is within %.1f ms of the one set and the %.1f ms of window and monitor (3 ms at most)\n", (most <= 3) ? "ok  " : "FAIL", most, sum / NR
  exit most > 3 }' "$folder/delays" || failed=1
end
