#!/bin/sh
# Installs a release archive of bramah for one user, and removes it again; `sh install.sh --help` says how.
# Exit status: 0 fine, 1 the archive or this machine is not fit, 2 bad arguments.
set -eu
umask 022

usage() {
    cat <<'TEXT'
usage: sh install.sh ARCHIVE [--prefix DIR]     ARCHIVE: a file or an address, bramah-VERSION-x86_64-linux.tar.gz
       sh install.sh --uninstall [--prefix DIR]

DIR is ~/.local when it is not given; that needs no root. The checksum file ARCHIVE.sha256 is used when it is there.
TEXT
}

say() { printf '%s\n' "$*"; }

# fail TEXT [WHAT-TO-DO]
fail() {
    say "error: $1" >&2
    if [ $# -gt 1 ]; then say "help: $2" >&2; fi
    exit 1
}

misused() {
    say "error: $1" >&2
    usage >&2
    exit 2
}

work=
# shellcheck disable=SC2317
clean() { if [ -n "$work" ]; then rm -rf "$work"; fi; }

# --- the archive -----------------------------------------------------------------------------------------------------

# download ADDRESS FILE: fails quietly; the caller knows what the file is for.
download() {
    if command -v curl >/dev/null 2>&1; then
        curl -fsSL -o "$2" "$1"
    elif command -v wget >/dev/null 2>&1; then
        wget -q -O "$2" "$1"
    else
        fail "neither curl nor wget is there to fetch $1" "fetch it by hand, then give the file"
    fi
}

# fetch ARCHIVE: `archive` and, when it is there, `sum` become files.
fetch() {
    sum=
    case $1 in
        *://*)
            name=${1##*/}
            archive=$work/archive.tar.gz
            download "$1" "$archive" || fail "$1 cannot be fetched"
            if download "$1.sha256" "$work/sum" 2>/dev/null; then sum=$work/sum; fi
            ;;
        *)
            name=${1##*/}
            archive=$1
            if [ ! -f "$archive" ]; then fail "there is no file $archive"; fi
            if [ -f "$archive.sha256" ]; then sum=$archive.sha256; fi
            ;;
    esac
}

hash_of() {
    if command -v sha256sum >/dev/null 2>&1; then
        sha256sum <"$1" | cut -d ' ' -f 1
    elif command -v shasum >/dev/null 2>&1; then
        shasum -a 256 <"$1" | cut -d ' ' -f 1
    else
        fail "neither sha256sum nor shasum is there to verify the archive"
    fi
}

# Of several lines, that of this archive; of one, its checksum whatever the archive is called now.
verify() {
    if [ -z "$sum" ]; then
        say "checksum: not verified, there is no $name.sha256 beside the archive"
        return 0
    fi
    wanted=$(awk -v name="$name" '{ file = $2; sub(/^\*/, "", file); if (file == name) { print $1; found = 1; exit } first = $1 }
        END { if (!found && NR == 1) print first }' "$sum")
    if [ -z "$wanted" ]; then fail "the checksum file names no $name"; fi
    got=$(hash_of "$archive")
    if [ "$got" != "$wanted" ]; then
        say "error: $name is damaged or not the released one: its checksum is wrong" >&2
        say "  expected $wanted" >&2
        say "  found    $got" >&2
        say "help: fetch the archive and its .sha256 again" >&2
        exit 1
    fi
    say "checksum: right"
}

# `root` becomes the unpacked folder.
unpack() {
    mkdir "$work/unpacked"
    gzip -dc "$archive" >"$work/tar" 2>/dev/null || fail "$name is no complete .tar.gz"
    if ! tar -tf "$work/tar" >"$work/names" 2>/dev/null; then fail "$name is no complete .tar.gz"; fi
    if grep -qE '^/|(^|/)\.\.(/|$)' "$work/names"; then fail "$name holds paths that lead out of it"; fi
    tar -xof "$work/tar" -C "$work/unpacked"
    rm "$work/tar"
    for root in "$work/unpacked"/*; do break; done
    if [ ! -f "$root/bramah" ] || [ ! -f "$root/NEEDS" ]; then fail "$name is no release archive of bramah"; fi
}

# --- this machine ----------------------------------------------------------------------------------------------------

needs() { sed -n "s/^$1 //p" "$root/NEEDS"; }

# The version of the C library, or nothing where it is another one (musl).
glibc() {
    have=$(getconf GNU_LIBC_VERSION 2>/dev/null | sed -n 's/^glibc //p')
    if [ -z "$have" ]; then
        have=$(ldd --version 2>/dev/null | sed -n '1s/^ldd (.*) //p')
    fi
    printf '%s\n' "$have"
}

# at_least HAVE WANTED: versions `major.minor`.
at_least() {
    [ "${1%%.*}" -gt "${2%%.*}" ] && return 0
    minor=${1#*.}
    [ "${1%%.*}" -eq "${2%%.*}" ] && [ "${minor%%[!0-9]*}" -ge "${2#*.}" ]
}

from_source="build it from source: README.md says how"

check_machine() {
    system=$(uname -s)
    machine=$(uname -m)
    if [ "$machine" = amd64 ]; then machine=x86_64; fi
    if [ "$system" != Linux ]; then fail "this archive is for Linux, and this is $system" "$from_source"; fi
    if [ "$machine" != "$(needs machine)" ]; then
        fail "this archive is for $(needs machine), and this machine is $machine" "$from_source"
    fi
    wanted=$(needs glibc)
    have=$(glibc)
    if [ -z "$have" ]; then fail "bramah needs glibc $wanted or newer, and this system has another C library" "$from_source"; fi
    if ! at_least "$have" "$wanted"; then
        fail "bramah needs glibc $wanted or newer, and this system has $have" "take a newer system, or $from_source"
    fi
    said="bramah $(needs version)"
    # Where programs may not run from the temporary folder (noexec), this last check is left out.
    if [ -x "$root/bramah" ] && ! said=$("$root/bramah" --version 2>&1); then
        fail "bramah does not run here: $said" "$from_source"
    fi
}

# --- what is installed -----------------------------------------------------------------------------------------------

# `$prefix/share/bramah/installed` lists it: `file PATH`, and `folder PATH` for each folder that was not there before.

# Puts the unpacked files where they belong below a prefix.
arrange() {
    stage=$work/stage
    share=$stage/share
    mkdir -p "$stage/bin" "$share/bash-completion/completions" "$share/zsh/site-functions" "$share/fish/vendor_completions.d" \
        "$share/man/man1" "$share/doc/bramah" "$share/bramah"
    mv "$root/bramah" "$stage/bin/bramah"
    # Archives before `bramah export` have no library for units.
    if [ -f "$root/libbramah_fmu.so" ]; then
        mkdir "$stage/lib" "$stage/lib/bramah"
        mv "$root/libbramah_fmu.so" "$stage/lib/bramah/"
    fi
    mv "$root/completions/bramah.bash" "$share/bash-completion/completions/bramah"
    mv "$root/completions/_bramah" "$share/zsh/site-functions/_bramah"
    mv "$root/completions/bramah.fish" "$share/fish/vendor_completions.d/bramah.fish"
    mv "$root/bramah.1" "$share/man/man1/bramah.1"
    mv "$root/install.sh" "$share/bramah/install.sh"
    rm -r "$root/completions" "$root/NEEDS"
    mv "$root"/* "$share/doc/bramah/"
}

# make_folder PATH: with its parents, each new one noted.
make_folder() {
    if [ -d "$prefix/$1" ]; then return 0; fi
    case $1 in */*) make_folder "${1%/*}" ;; esac
    mkdir "$prefix/$1" || fail "$prefix/$1 cannot be made" "choose another place with --prefix"
    say "folder $1" >>"$work/folders"
}

# A running bramah keeps its old file: the new one is put in its place by renaming.
put() {
    cp "$stage/$1" "$prefix/$1.new" || fail "$prefix/$1 cannot be written" "choose another place with --prefix"
    mv -f "$prefix/$1.new" "$prefix/$1"
}

# The list is there before the files, so that --uninstall also removes an installation that was cut short.
install_files() {
    list=share/bramah/installed
    (cd "$stage" && find . -type f | sed 's/^\.\///' | sort) >"$work/files"
    mkdir -p "$prefix" 2>/dev/null || fail "$prefix cannot be made" "choose another place with --prefix"
    if [ ! -w "$prefix" ]; then fail "$prefix cannot be written" "choose another place with --prefix"; fi
    if [ -e "$prefix/bin/bramah" ] && [ ! -f "$prefix/$list" ]; then
        fail "$prefix/bin/bramah is there and does not come from this script" "remove it, or choose another place with --prefix"
    fi
    : >"$work/old"
    if [ -f "$prefix/$list" ]; then cp "$prefix/$list" "$work/old"; fi
    grep '^folder ' "$work/old" >"$work/folders" || true
    while read -r file; do make_folder "${file%/*}"; done <"$work/files"
    sed 's/^/file /' "$work/files" | cat - "$work/folders" >"$work/new"
    sort -u "$work/old" "$work/new" >"$prefix/$list"
    while read -r file; do put "$file"; done <"$work/files"
    # What an older release had and this one has not.
    sed -n 's/^file //p' "$work/old" | while read -r file; do
        if safe "$file" && ! grep -qxF "$file" "$work/files"; then rm -f "$prefix/$file"; fi
    done
    sort -u "$work/new" >"$prefix/$list"
}

# safe PATH: below the prefix, whatever someone wrote into the list.
safe() {
    case /$1/ in
        // | //* | */../*) return 1 ;;
    esac
}

uninstall() {
    list=share/bramah/installed
    if [ ! -f "$prefix/$list" ]; then
        fail "nothing that this script installed is in $prefix" "say with --prefix where it was installed"
    fi
    cp "$prefix/$list" "$work/old"
    sed -n 's/^file //p' "$work/old" | while read -r file; do
        if safe "$file"; then rm -f "$prefix/$file"; fi
    done
    rm -f "$prefix/$list"
    # Deepest first; a folder that holds anything else stays.
    sed -n 's/^folder //p' "$work/old" | sort -r | while read -r folder; do
        if safe "$folder"; then rmdir "$prefix/$folder" 2>/dev/null || true; fi
    done
    say "removed bramah from $prefix ($(grep -c '^file ' "$work/old") files)"
}

report() {
    say "installed $said:"
    say "  $prefix/bin/bramah"
    say "  $prefix/share/doc/bramah    README, licences, examples"
    say "  completions for bash, zsh and fish, and a man page, below $prefix/share"
    case :$PATH: in
        *:"$prefix/bin":*) ;;
        *) say "$prefix/bin is not in your PATH: add  export PATH=\"$prefix/bin:\$PATH\"  to your shell's start file" ;;
    esac
    case ${SHELL:-} in
        */zsh) say "for completions in zsh, add  fpath=('$prefix/share/zsh/site-functions' \$fpath)  before compinit in ~/.zshrc" ;;
    esac
    say "first steps:  bramah new press && bramah simulate press/press.toml"
    say "to remove it: sh '$prefix/share/bramah/install.sh' --uninstall --prefix '$prefix'"
}

main() {
    source=
    removal=
    prefix=
    while [ $# -gt 0 ]; do
        case $1 in
            --prefix)
                if [ $# -lt 2 ]; then misused "--prefix needs a folder"; fi
                prefix=$2
                shift
                ;;
            --prefix=*) prefix=${1#--prefix=} ;;
            --uninstall) removal=yes ;;
            -h | --help)
                usage
                exit 0
                ;;
            -*) misused "there is no option $1" ;;
            *)
                if [ -n "$source" ]; then misused "give one archive"; fi
                source=$1
                ;;
        esac
        shift
    done
    if [ -z "$removal$source" ]; then misused "give the archive to install"; fi
    if [ -n "$removal" ] && [ -n "$source" ]; then misused "--uninstall takes no archive"; fi
    if [ -z "$prefix" ]; then
        if [ -z "${HOME:-}" ]; then misused "HOME is not set: give --prefix"; fi
        prefix=$HOME/.local
    fi
    # shellcheck disable=SC2088
    case $prefix in
        "~/"*) prefix=$HOME/${prefix#"~/"} ;;
        /*) ;;
        *) prefix=$PWD/$prefix ;;
    esac
    prefix=${prefix%/}

    work=$(mktemp -d)
    trap clean EXIT
    trap 'exit 1' HUP INT TERM
    if [ -n "$removal" ]; then
        uninstall
    else
        fetch "$source"
        verify
        unpack
        check_machine
        arrange
        install_files
        report
    fi
}

# The whole script is read before it runs: it may replace or remove its own file.
main "$@"
exit 0
