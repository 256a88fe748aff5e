# Sourced by scripts that test with Python: `fresh_venv PACKAGE...` makes a virtual environment with these packages in a
# temporary folder, which goes when the script ends. `work` is the folder, `bin` that of the environment's programs.
#
# PYTHON: the interpreter (python3). Where there is none, or no way to PyPI, the script prints `skipped: ...` and exits with 0.

skipped() {
    echo "skipped: $1"
    exit 0
}

fresh_venv() {
    python=${PYTHON:-python3}
    work=$(mktemp -d)
    bin=$work/venv/bin
    trap 'rm -rf "$work"' EXIT
    trap 'exit 130' INT TERM
    # nothing of the caller's environment, and nothing written beside the source
    unset PYTHONPATH PYTHONHOME
    export PYTHONDONTWRITEBYTECODE=1 PIP_DISABLE_PIP_VERSION_CHECK=1
    "$python" -c 'import sys; sys.exit(sys.version_info < (3, 10))' 2>/dev/null ||
        skipped "$python is not Python 3.10 or newer"
    "$python" -m venv "$work/venv" >"$work/log" 2>&1 ||
        skipped "$python makes no virtual environments (on Debian: python3-venv)"
    "$bin/pip" install --quiet --retries 1 --timeout 20 "$@" >"$work/log" 2>&1 ||
        skipped "PyPI cannot be reached: $(grep -v '^ *$' "$work/log" | tail -n 1)"
}
