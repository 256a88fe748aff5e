#!/usr/bin/env bash
# Runs what a new user runs, one line `ok` or `FAIL` each: packaging/smoke.sh BINARY [EXAMPLES]
#
# EXAMPLES is the folder `examples` of a release; without it, that of the checkout.
# Exit status: 0 all fine, 1 something failed, 2 bad arguments.
# Functions are called by `try`, which shellcheck does not see.
# shellcheck disable=SC2317
set -uo pipefail

if [ $# -lt 1 ] || [ $# -gt 2 ] || [ ! -x "$1" ]; then
    printf 'usage: packaging/smoke.sh BINARY [EXAMPLES]\n' >&2
    exit 2
fi
binary=$(realpath "$1")
examples=$(realpath "${2:-$(dirname "${BASH_SOURCE[0]}")/../examples}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 2

failed=0

# try NAME COMMAND...: the command must succeed; what it printed is shown where it does not.
try() {
    local name=$1 status=0
    shift
    "$@" >"$work/said" 2>&1 </dev/null || status=$?
    if [ "$status" -eq 0 ]; then
        printf 'ok    %s\n' "$name"
    else
        printf 'FAIL  %s (status %s)\n' "$name" "$status"
        sed 's/^/      /' "$work/said" | head -n 20
        failed=1
    fi
}

run() { timeout 60 "$binary" "$@"; }

# has TEXT FILE
has() { grep -qF -- "$1" "$2" || { printf 'no %s in %s\n' "$1" "$2"; return 1; }; }

version() { run --version | tee version.txt && has 'bramah ' version.txt; }

new() { run new press && [ -s press/Press.mo ] && [ -s press/press.toml ]; }

simulate() { run simulate press/press.toml -o press.csv && has time press.csv && [ "$(wc -l <press.csv)" -gt 10 ]; }

plot_svg() { run plot press.csv -o press.svg && has '<svg' press.svg; }

# Letters need the fonts that are built in.
plot_png() { run plot press.csv -o press.png && [ "$(head -c 4 press.png | tail -c 3)" = PNG ]; }

explain_code() { run explain E103 >explain.txt && has E103 explain.txt; }

explain_class() { run explain Hydraulic.Cylinder >explain.txt && has port_1 explain.txt; }

# Names in a ZIP file stand there as they are.
export_unit() {
    run export press/Press.mo -o press.fmu --outputs line.p && [ "$(head -c 2 press.fmu)" = PK ] &&
        has modelDescription.xml press.fmu && has binaries/x86_64-linux/bramah.so press.fmu
}

# A model that is wrong must be refused, with status 1.
refuse() {
    local status=0
    sed 's/^ *connect(.*//' press/Press.mo >Wrong.mo
    run check Wrong.mo || status=$?
    [ "$status" -eq 1 ]
}

message() { printf 'Content-Length: %d\r\n\r\n%s' "${#1}" "$1"; }

lsp() {
    {
        message '{"jsonrpc":"2.0","id":1,"method":"initialize","params":{"processId":null,"rootUri":null,"capabilities":{}}}'
        message '{"jsonrpc":"2.0","method":"initialized","params":{}}'
        message '{"jsonrpc":"2.0","id":2,"method":"shutdown","params":null}'
        message '{"jsonrpc":"2.0","method":"exit","params":null}'
    } | run lsp >lsp.txt && has '"capabilities"' lsp.txt && has '"id":2' lsp.txt
}

first_circuit() { run simulate "$examples/first_circuit/Press.mo" -o first.csv && [ "$(wc -l <first.csv)" -gt 10 ]; }

gap() {
    timeout 30 "$binary" gap "$examples/diagnosis/gap.toml" -o verdict.json
    local status=$?
    if [ "$status" -eq 124 ]; then printf 'it takes longer than 30 s here\n'; fi
    [ "$status" -eq 0 ] && has external_leak verdict.json
}

try '--version' version
try 'new press' new
try 'check press/Press.mo' run check press/Press.mo
try 'check a circuit without connections: refused' refuse
try 'simulate press/press.toml' simulate
try 'plot press.csv: SVG' plot_svg
try 'plot press.csv: PNG' plot_png
try 'explain E103' explain_code
try 'explain Hydraulic.Cylinder' explain_class
try 'export a unit for other tools' export_unit
try 'fmt --check press/Press.mo' run fmt --check press/Press.mo
try 'lsp: initialize, shutdown' lsp
if [ -d "$examples/first_circuit" ]; then try 'simulate examples/first_circuit/Press.mo' first_circuit; fi
if [ -d "$examples/diagnosis" ]; then try 'gap examples/diagnosis/gap.toml' gap; fi
exit "$failed"
