#!/bin/bash
# make_pictures.sh PLANLIGHT [FOLDER]: makes the pictures of this guide anew, as the program's own commands show them, in the simulated room
# (FOLDER: where all of them are put; default: where they belong). Needs xvfb-run, xdotool, ImageMagick, pdftoppm (of poppler-utils) and chromium; takes some minutes. Look at each
# before it is kept. `cameras.png`, `guided.png` and `doctor.png` are left by `tests/app/windows/two_monitors.sh` (cameras, calibrate_served_room, doctor).
set -e
here=$(cd "$(dirname "$0")" && pwd)
program=$(realpath "$1") out=$here example=$here/../example windows=$here/../windows
[ -z "$2" ] || { mkdir -p "$2" && out=$(realpath "$2") && example=$out && windows=$out; }
volume=/usr/share/doc/invesalius-examples/examples/Cranium.inv3
plan=$here/../example/frontal_defect.mrk.json
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
screen() { LIBGL_ALWAYS_SOFTWARE=1 xvfb-run -a -s "-screen 0 1440x900x24" "$@"; }
small() { convert "$1" -strip -colors 256 "PNG8:$2"; }
page() { pdftoppm -r 96 -f 1 -l 1 -png -singlefile "$1" "${1%.pdf}"; small "${1%.pdf}.png" "$2"; }

cd "$work"
"$program" prepare "$volume" --plan "$plan" --patient "E. M." --plan-name "Frontal defect" --plan-version 1 --out case --pdf preparation.pdf
page preparation.pdf "$out/preparation.png"
"$program" simulate --board "charuco 10x7 25 mm" --preset paper --seed 1 --out board
"$program" calibrate board/captures --board "charuco 10x7 25 mm" --out rig.json --pdf calibration.pdf
page calibration.pdf "$out/calibration.png"
"$program" projector --simulate paper --out projector.json --pdf projector.pdf
page projector.pdf "$out/projector.png"

# A session by its keys; each state leaves a picture that is named after it.
cat >session.sh <<'END'
"$1" session case --volume "$2" --preset paper --seed 3 --record all --recordings recordings --operator-name "Dr. A. Meier" \
  --screenshots shots 2>said & session=$!
last=
shown() {  # shown STATE: waits for a picture of it that is newer than the last one
  for i in $(seq 1200); do
    newest=$(ls shots/operator-*-"$1".png 2>/dev/null | tail -1)
    [[ -n "$newest" && "$newest" > "$last" ]] && { last=$newest; sleep 0.5; return; }
    kill -0 $session 2>/dev/null || break
    sleep 0.1
  done
  echo "$1 was not shown: $(cat said)" >&2; exit 1
}
press() { xdotool key "$1"; }
shown ready; press s; shown scanning; cp "$last" scanning.png; shown ready; press r; shown ready; cp "$last" match.png
press l; sleep 4; import -window root landmarks.png; press l; sleep 1
press t; shown check-show-landmarks; press c; shown check-light-1-is-right
press c; shown check-light-2-is-right; cp "$last" verify.png; press c; shown aligned
cp "$last" aligned.png; cp "${last/operator-/light-}" light.png; sleep 20
xdotool key x; sleep 2; kill $session; wait $session
exit 0
END
screen bash session.sh "$program" "$volume"
for name in scanning match verify aligned light; do small $name.png "$out/session-$name.png"; done
small aligned.png "$example/demo.png"
small landmarks.png "$windows/landmarks.png"
screen "$program" review recordings/*.plrec --case case --show --at 4 --picture review.png
small review.png "$out/session-review.png"
"$program" review recordings/*.plrec --case case --at 4 --out review
chromium --headless --no-sandbox --hide-scrollbars --window-size=1000,1500 --screenshot=review-page.png "file://$work/review/index.html"
small review-page.png "$out/review-page.png"
"$program" report recordings/*.plrec --out operation.html --pdf operation.pdf
page operation.pdf "$out/operation.png"

# A match from files, and its certificate.
"$program" simulate "$volume" --plan "$plan" --preset paper --seed 3 --frames 0 --out room
"$program" scan room/capture --rig room/rig.json --out cloud.ply
"$program" register case --cloud cloud.ply --pdf certificate.pdf --out registration.json
page certificate.pdf "$out/certificate.png"
for view in after error; do
  "$program" review case --registration registration.json --cloud cloud.ply --view $view --picture $view.png
done
small after.png "$out/match.png"
small error.png "$out/off.png"
