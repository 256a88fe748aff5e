#!/bin/sh
# Tests of the Python package as a user gets it: builds the wheel, installs it with what its tests need into a fresh
# virtual environment in a temporary folder, runs pytest there.
#
#   python/test.sh [WHEEL] [-- ARGUMENTS OF PYTEST]
#
# WHEEL: use this one instead of building an unoptimized one. PYTHON: the interpreter (python3). Without a way to PyPI it
# prints `skipped: ...` and exits with 0; else with the status of pytest.
set -eu

here=$(cd "$(dirname "$0")" && pwd)
wheel=
if [ $# -gt 0 ] && [ "$1" != "--" ]; then
    wheel=$(cd "$(dirname "$1")" && pwd)/$(basename "$1")
    [ -f "$wheel" ] || { echo "there is no wheel $1" >&2; exit 2; }
    shift
fi
[ "${1:-}" != "--" ] || shift

. "$here/../tests/venv.sh"
fresh_venv pytest

if [ -z "$wheel" ]; then
    "$bin/pip" install --quiet 'maturin>=1.9,<2'
    # the target folder of the repository: dependencies that it has are not built again
    CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-$here/../target} "$bin/maturin" build \
        --manifest-path "$here/Cargo.toml" --interpreter "$bin/python" --out "$work/wheels"
    wheel=$(ls "$work"/wheels/*.whl)
fi
"$bin/pip" install --quiet "${wheel}[test]"

# not through `python -m pytest`, and not from this folder: the source has no core
cd "$here/tests"
status=0
"$bin/pytest" -p no:cacheprovider "$@" . || status=$?
exit $status
