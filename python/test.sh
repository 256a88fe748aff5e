#!/bin/sh
# Tests of the Python package as a user gets it: builds the wheel, installs it with what its tests need into a fresh
# virtual environment in a temporary folder, runs pytest there.
#
#   python/test.sh [WHEEL] [-- ARGUMENTS OF PYTEST]
#
# WHEEL: use this one instead of building. PYTHON: the interpreter (python3). Without a way to PyPI it prints
# `skipped: ...` and exits with 0; else with the status of pytest.
set -eu

here=$(cd "$(dirname "$0")" && pwd)
python=${PYTHON:-python3}
wheel=
if [ $# -gt 0 ] && [ "$1" != "--" ]; then
    wheel=$(cd "$(dirname "$1")" && pwd)/$(basename "$1")
    [ -f "$wheel" ] || { echo "there is no wheel $1" >&2; exit 2; }
    shift
fi
[ "${1:-}" != "--" ] || shift

skipped() {
    echo "skipped: $1"
    exit 0
}

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT TERM
# nothing of the caller's environment, and nothing written beside the source
unset PYTHONPATH PYTHONHOME
export PYTHONDONTWRITEBYTECODE=1 PIP_DISABLE_PIP_VERSION_CHECK=1

"$python" -c 'import sys; sys.exit(sys.version_info < (3, 10))' 2>/dev/null || skipped "$python is not Python 3.10 or newer"
"$python" -m venv "$work/venv" >"$work/log" 2>&1 || skipped "$python makes no virtual environments (on Debian: python3-venv)"
bin=$work/venv/bin
"$bin/pip" install --quiet --retries 1 --timeout 20 pytest >"$work/log" 2>&1 ||
    skipped "PyPI cannot be reached: $(grep -v '^ *$' "$work/log" | tail -n 1)"

if [ -z "$wheel" ]; then
    "$bin/pip" install --quiet 'maturin>=1.9,<2'
    # the target folder of the repository: dependencies that it has are not built again
    CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-$here/../target} "$bin/maturin" build --release \
        --manifest-path "$here/Cargo.toml" --interpreter "$bin/python" --out "$work/wheels"
    wheel=$(ls "$work"/wheels/*.whl)
fi
"$bin/pip" install --quiet "${wheel}[test]"

# not through `python -m pytest`, and not from this folder: the source has no core
cd "$here/tests"
status=0
"$bin/pytest" -p no:cacheprovider "$@" . || status=$?
exit $status
