#!/bin/sh
# Units in the hands of FMPy, as a user of another tool meets them: fmu/test.sh [BRAMAH]
#
# BRAMAH: the command, with libbramah_fmu.so beside it; without it, both are built (unoptimized). PYTHON: the interpreter
# (python3). Without a way to PyPI it prints `skipped: ...` and exits with 0; else with the status of fmu/test.py.
set -eu

here=$(cd "$(dirname "$0")" && pwd)
. "$here/../tests/venv.sh"
fresh_venv fmpy numpy

if [ $# -gt 0 ]; then
    binary=$1
else
    (cd "$here/.." && cargo build --quiet --bin bramah && cargo build --quiet -p bramah-fmu)
    binary=${CARGO_TARGET_DIR:-$here/../target}/debug/bramah
fi
"$bin/python" "$here/test.py" "$binary" --quick
