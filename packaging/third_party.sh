#!/usr/bin/env bash
# Prints the licences of everything that is linked into the command: what a binary must bring along.
#
# Which crates, and where their sources lie, is what cargo says for Cargo.lock; a text that many share is printed once.
set -euo pipefail
export LC_ALL=C
cd "$(dirname "${BASH_SOURCE[0]}")/.."

triple=x86_64-unknown-linux-gnu
declare -A folders users
texts=()

say() { printf '%s\n' "$*" >&2; }

# Lines `name version|licence`, without bramah itself.
crates() {
    cargo tree --locked --edges normal --prefix none --target "$triple" --format '{p}|{l}' |
        sed 's/ (\*)$//; s/ (proc-macro)|/|/; s/ v\([0-9]\)/ \1/; /^bramah /d' | sort -u
}

# `folders` becomes: name-version of a crate, the folder of its sources.
find_folders() {
    local path
    while read -r path; do
        folders[$(basename "$path")]=$path
    done < <(cargo metadata --locked --format-version 1 --filter-platform "$triple" |
        grep -o '"manifest_path":"[^"]*"' | sed 's/^"manifest_path":"//; s/\/Cargo.toml"$//')
}

# Texts of licences in a folder: crates have them on top, C sources and fonts deeper.
texts_in() {
    find "$1" -maxdepth 5 -type f \( -iname 'licen[sc]e*' -o -iname '*-licen[sc]e*' -o -iname 'copying*' -o -iname 'notice*' \
        -o -iname 'unlicense*' -o -iname 'ofl*' -o -iname 'ufl*' -o -iname 'hack-regular.txt' \) ! -name '*.rs' ! -name '*.py' | sort
}

# collect NAME FOLDER: remembers who uses each text.
collect() {
    local name=$1 file key
    while read -r file; do
        key=$(sha256sum <"$file" | cut -c1-64)
        if [ -z "${users[$key]:-}" ]; then
            texts+=("$key $file")
            users[$key]=$name
        elif [[ " ${users[$key]}," != *" $name,"* ]]; then
            users[$key]+=", $name"
        fi
    done < <(texts_in "$2")
}

rows=$(crates)
find_folders
cat <<'TEXT'
What the command bramah contains besides its own code
=====================================================

Rust's standard library (MIT OR Apache-2.0; copyright the Rust Project contributors), and these crates. `sundials-sys`
brings SUNDIALS, `libmimalloc-sys` brings mimalloc, `epaint_default_fonts` brings fonts. The texts follow below.
A crate marked * has no text in its package: the common text of the licence named holds.

TEXT
while IFS='|' read -r crate licence; do
    name=${crate/ /-}
    folder=${folders[$name]:-}
    if [ -z "$folder" ]; then
        say "error: the sources of $crate are not there"
        exit 1
    fi
    mark=
    if [ -z "$(texts_in "$folder")" ]; then mark=' *'; fi
    printf '%s: %s%s\n' "$crate" "${licence:-see its text}" "$mark"
    collect "$crate" "$folder"
done <<<"$rows"
for text in "${texts[@]}"; do
    printf '\n%s\n' '--------------------------------------------------------------------------------'
    printf '%s\n\n' "${users[${text%% *}]}:" | fold -s -w 100 | sed 's/ *$//'
    tr -d '\r' <"${text#* }"
done
