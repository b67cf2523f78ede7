#!/bin/bash
# measure_long_session.sh FOLDER: a long session in the room served as hardware, on the display with two monitors that two_monitors.sh made,
# by the program's own commands, both windows open: memory and descriptors of its main process and of the projector's every ten seconds,
# and what became of every exposure. Fails when memory grew by more than 5 MiB after settling, a descriptor was leaked, or an exposure is
# unaccounted for. $MINUTES of following (default 120), $SETTLE_MINUTES of them before growth counts (default 10), $SPEED_MM_S of the head
# (default 0), $PLANLIGHT the program, $PLAN the plan. That it can fail: $LEAK = memory, descriptors (of the main process, by $LEAK_LIBRARY,
# which is this test's own, beside 200 KiB and a descriptor every second) or frames (as if updates had not been counted). By hand, two hours:
#   MINUTES=120 PROGRAM_SECONDS=8000 SECOND_MONITOR=800x600 PLANLIGHT=build/app/planlight PLAN=app/example/frontal_defect.mrk.json \
#     nice tests/app/windows/two_monitors.sh tests/app/windows/measure_long_session.sh tests/app/windows/two_monitor_xorg.conf /tmp/long none
. "$(dirname "$0")/serving.sh"
every=10 rate_hz=25 minutes=${MINUTES:-120} settle=${SETTLE_MINUTES:-10}
rm -rf "$folder"/{case,room,served,errors,samples,session.json,projector.json}
prepare_case
serve_patient "$folder/room" 1 --speed-mm-s "${SPEED_MM_S:-0}"
measure_delay || { cat "$folder/errors"; failed=1; end; }
name_projector_file "$folder/room/room.json"
case $LEAK in memory | descriptors) preload=(LD_PRELOAD="$LEAK_LIBRARY") ;; *) preload=() ;; esac
env "${preload[@]}" "$PLANLIGHT" session "$folder/case" --room "$folder/room/room.json" --operator DUMMY0 --autoplay --record events --json \
  --end-after-s $((60 * minutes)) >"$folder/session.json" 2>"$folder/errors" & session=$!

of() { awk -v n="$2:" '$1 == n { printf "%.1f", $2 / 1024; found = 1 } END { if (!found) print "-" }' "/proc/$1/smaps_rollup" 2>/dev/null; }  # PID Rss: MiB
descriptors() { ls "/proc/$1/fd" 2>/dev/null | wc -l; }
echo "  min | session: RSS  PSS MiB  descriptors | projector: RSS  PSS MiB  descriptors"
while kill -0 $session 2>/dev/null; do
  sleep $every
  light=$(pgrep -P $session -f projector-window | head -1)
  [ -n "$light" ] || continue  # it has not begun yet, or is over
  [ -n "$began" ] || began=$(date +%s)
  minute=$(awk "BEGIN { printf \"%.2f\", ($(date +%s) - $began) / 60 }")
  line="$minute $(of $session Rss) $(of $session Pss) $(descriptors $session) $(of $light Rss) $(of $light Pss) $(descriptors $light)"
  [[ "$line" == *-* ]] || [ "$(wc -w <<<"$line")" != 7 ] || echo "$line" >>"$folder/samples"
  [ $(($(wc -l <"$folder/samples") % 6)) = 1 ] && awk '{ printf "%5.1f | %12s %8s %10s | %14s %8s %10s\n", $1, $2, $3, $4, $5, $6, $7 }' <<<"$line"
done
wait $session; code=$?; session=
check "the session ends by itself without a fault" "$(is "$code == 0")" "exit code $code: $(tail -3 "$folder/errors")"

# Against the minute after settling, the last minute: medians, so that neither a single sample nor a saw's tooth decides. What both RSS and
# PSS say grew: a page that is shared no longer, or a file that is read again, is in one of them only.
grown() {  # COLUMN: of its values, by how much the median of the last six is above that of the first six
  awk -v c="$1" -v s="$settle" '$1 >= s { print $c }' "$folder/samples" >"$folder/column"
  [ "$(wc -l <"$folder/column")" -ge 12 ] || { echo none; return; }
  awk -v a="$(head -6 "$folder/column" | sort -g | sed -n 4p)" -v b="$(tail -6 "$folder/column" | sort -g | sed -n 4p)" 'BEGIN { printf "%.1f", b - a }'
}
for part in session:2:3:4 projector:5:6:7; do
  IFS=: read -r name rss pss open <<<"$part"
  more_rss=$(grown $rss) more_pss=$(grown $pss) more_open=$(grown $open)
  if [ "$more_rss" = none ]; then check "$name: long enough to be judged" 0 "less than two minutes beyond the first $settle"; continue; fi
  check "$name: memory after $settle minutes: RSS $more_rss MiB, PSS $more_pss MiB more at the end" "$(is "$more_rss <= 5 || $more_pss <= 5")" "5 MiB at most"
  check "$name: $more_open descriptors more" "$(is "$more_open <= 0")" "none may be"
done

figure() { awk -F'[:,]' -v n="\"$1\"" '$1 ~ n { print $2 + 0; exit }' "$folder/session.json"; }
updates=$(figure updates) skipped=$(figure skipped) missed=$(figure missed) pauses=$(figure pauses) followed=$(figure followed_s)
[ -n "$followed" ] || { check "the session says what became of its frames" 0 "$(tail -3 "$folder/session.json")"; end; }
[ "$LEAK" = frames ] && updates=$((updates - updates / 50))
exposed=$(awk "BEGIN { printf \"%d\", $followed * $rate_hz + 0.5 }")
unaccounted=$(($exposed - ($updates - 1 - $pauses + $skipped + $missed)))
echo "exposures while following: $exposed in $followed s; updates $updates (lit $(figure lit), later than 30 ms $(figure later_than_30_ms)), skipped $skipped, missed $missed; $pauses pauses of $(figure paused_s) s in all"
grep '"dark"' "$folder/session.json"
# The room exposes by its own clock, the session counts by its cameras' clocks on its own: a thousandth for their difference.
check "it followed the patient for most of the time" "$(is "$followed > 30 * $minutes")" "$followed s of $minutes minutes"
check "every exposure is accounted for, but $unaccounted" "$(is "$updates > 0 && $unaccounted * $unaccounted <= (2 + $exposed / 1000) ^ 2")" "of $exposed"
end
