#!/bin/sh
# Units in the hands of FMPy, as a user of another tool meets them: fmu/test.sh [BRAMAH]
#
# BRAMAH: the command, with libbramah_fmu.so beside it; without it, both are built (unoptimized). PYTHON: the interpreter
# (python3). Without a way to PyPI it prints `skipped: ...` and exits with 0; else with the status of fmu/test.py.
set -eu

here=$(cd "$(dirname "$0")" && pwd)
python=${PYTHON:-python3}
skipped() {
    echo "skipped: $1"
    exit 0
}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT TERM

"$python" -c 'import sys; sys.exit(sys.version_info < (3, 10))' 2>/dev/null || skipped "$python is not Python 3.10 or newer"
"$python" -m venv "$work/venv" >"$work/log" 2>&1 || skipped "$python makes no virtual environments (on Debian: python3-venv)"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check --retries 1 --timeout 20 fmpy numpy >"$work/log" 2>&1 ||
    skipped "PyPI cannot be reached: $(grep -v '^ *$' "$work/log" | tail -n 1)"

if [ $# -gt 0 ]; then
    binary=$1
else
    (cd "$here/.." && cargo build --quiet --bin bramah && cargo build --quiet -p bramah-fmu)
    binary=${CARGO_TARGET_DIR:-$here/../target}/debug/bramah
fi
"$work/venv/bin/python" "$here/test.py" "$binary" --quick
