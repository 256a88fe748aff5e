#!/usr/bin/env bash
# Opens pages of the handbook once in a headless Chromium: `browse.sh OUT`.
#
# The browser has no network. Fails when a page logs an error, asks for anything, or lacks what it should show.
# Screenshots go to OUT/../handbook_shots. Exit status: 0 fine, 1 something is wrong, 2 there is no browser.
set -euo pipefail
out=$(realpath "${1:?usage: browse.sh OUT}")
shots=$(dirname "$out")/handbook_shots
browser=
for name in chromium chromium-browser google-chrome chrome; do
    if command -v "$name" >/dev/null; then browser=$name; break; fi
done
if [ -z "$browser" ]; then
    echo "error: there is no Chromium (Debian: apt-get install chromium)" >&2
    exit 2
fi

profile=$(mktemp -d)
trap 'rm -rf "$profile"' EXIT
mkdir -p "$shots"

chrome() {
    timeout 60 "$browser" --headless --no-sandbox --disable-gpu --hide-scrollbars --user-data-dir="$profile" \
        --disable-background-networking --host-resolver-rules='MAP * ~NOTFOUND' --enable-logging=stderr --log-level=0 "$@"
}

# open PAGE TEXT: the page as the browser sees it must hold TEXT.
open() {
    local page=$1 wanted=$2 name log dom
    name=$(basename "$page" .html)
    log=$shots/$name.log
    dom=$(chrome --dump-dom "file://$out/$page" 2>"$log")
    chrome --window-size=1280,2400 --screenshot="$shots/$name.png" "file://$out/$page" >/dev/null 2>>"$log"
    if grep -E 'CONSOLE|ERR_FILE_NOT_FOUND|ERR_NAME_NOT_RESOLVED' "$log"; then
        echo "error: $page is not quiet" >&2
        return 1
    fi
    if ! grep -qF "$wanted" <<<"$dom"; then
        echo "error: $page does not show: $wanted" >&2
        return 1
    fi
    rm "$log"
    echo "opened: $page"
}

open index.html 'A first circuit in ten minutes'
open all.html 'Hydraulic.Pump'
open reference/Hydraulic.html 'AxialPistonMachine'
open reference/Hydraulic.Pump.html '<msub>'
open reference/Signal.LimPI.html '<svg class="box"'
open book/first_circuit.html 'bramah simulate'
open book/papers/servo_pump.html '0.7682'
open book/errors/E103.html 'E103'
echo "screenshots: $shots"
