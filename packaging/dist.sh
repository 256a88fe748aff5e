#!/usr/bin/env bash
# Makes the files of a release from a built binary: packaging/dist.sh VERSION BINARY OUTDIR
#
# The library for units, libbramah_fmu.so, lies beside BINARY; it goes into both, stripped.
#
#   bramah-VERSION-x86_64-linux.tar.gz   for install.sh, or to unpack by hand
#   bramah_VERSION_amd64.deb             for Debian and Ubuntu
#   *.sha256                             the checksum of each
#
# The same binary gives the same bytes: names are sorted, everything belongs to root, and every time is SOURCE_DATE_EPOCH
# or, without it, that of the last commit. MAINTAINER="Name <address>" is who the Debian package names.
# Exit status: 0 fine, 1 the binary is not fit, 2 bad arguments or something needed is missing.
set -euo pipefail
export LC_ALL=C TZ=UTC
umask 022

say() { printf '%s\n' "$*" >&2; }

fail() {
    say "error: $1"
    exit "${2:-1}"
}

if [ $# -ne 3 ]; then
    say 'usage: packaging/dist.sh VERSION BINARY OUTDIR'
    exit 2
fi
version=$1
[[ $version =~ ^[0-9]+\.[0-9]+\.[0-9]+(-[0-9A-Za-z.]+)?$ ]] || fail "\`$version\` is no version such as 0.1.0" 2
[ -f "$2" ] || fail "there is no binary $2" 2
# Debian sorts 1.0.0~rc.1 before 1.0.0, as it is meant, and 1.0.0-rc.1 after it.
deb_version=${version/-/\~}
binary=$(realpath "$2")
unit_library=${binary%/*}/libbramah_fmu.so
[ -f "$unit_library" ] || fail "there is no $unit_library: \`cargo build --release -p bramah-fmu\` makes it" 2
mkdir -p "$3"
out=$(realpath "$3")
cd "$(dirname "${BASH_SOURCE[0]}")/.."

maintainer=${MAINTAINER:-The bramah authors <authors@bramah.invalid>}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# --- what the binary is ----------------------------------------------------------------------------------------------

need_tools() {
    local tool
    for tool in objdump strip tar gzip sha256sum dpkg-deb cargo; do
        command -v "$tool" >/dev/null || fail "\`$tool\` is needed (Debian: binutils, dpkg, coreutils; cargo from rustup)" 2
    done
}

need_date() {
    local commit
    if [ -z "${SOURCE_DATE_EPOCH:-}" ]; then
        commit=$(git log -1 --format=%ct 2>/dev/null) || fail 'without a commit, SOURCE_DATE_EPOCH must say the time' 2
        SOURCE_DATE_EPOCH=$commit
    fi
    export SOURCE_DATE_EPOCH
}

check_binary() {
    local said
    objdump -f "$binary" 2>/dev/null | grep -q 'file format elf64-x86-64' || fail "$binary is no program for x86_64"
    said=$("$binary" --version </dev/null) || fail "$binary does not run"
    [ "$said" = "bramah $version" ] || fail "$binary is \`${said%%$'\n'*}\`, not bramah $version"
}

check_library() {
    local name
    objdump -f "$unit_library" 2>/dev/null | grep -q 'file format elf64-x86-64' || fail "$unit_library is no library for x86_64"
    for name in fmi2DoStep fmi3DoStep; do
        # not `grep -q`, which ends before objdump has written everything
        objdump -T "$unit_library" | grep " $name$" >/dev/null || fail "$unit_library is no library for units: it has no $name"
    done
}

# Lines `LIBRARY VERSION` of all that the loader will look for, for example `libm.so.6 GLIBC_2.35`, for the program and the
# library: the loader refuses them when one is missing, so this table of the file, not its list of symbols, decides.
references() {
    objdump -p "$binary" "$unit_library" | awk '/required from/ { sub(":", "", $3); library = $3; next }
        /^Version definitions|file format/ { library = "" } library != "" && NF == 4 { print library, $4 }'
}

# newest PREFIX: the newest version of `references` with that prefix, `GLIBC_` or `GCC_`.
newest() { references | sed -n "s/^[^ ]* $1\([0-9.]*\)$/\1/p" | sort -V | tail -n 1; }

# The packages of Debian that hold these libraries. On Debian 12, dpkg-shlibdeps says the same.
depends() {
    local library list
    list="libc6 (>= $(newest GLIBC_))"
    while read -r library; do
        case $library in
            libc.so.6 | libm.so.6 | libpthread.so.0 | libdl.so.2 | librt.so.1 | ld-linux-x86-64.so.2) ;;
            libgcc_s.so.1) list+=", libgcc-s1 (>= $(newest GCC_ | cut -d. -f1-2))" ;;
            *) fail "no package of Debian is known here for $library: add it to \`depends\` of packaging/dist.sh" ;;
        esac
    done < <(objdump -p "$binary" "$unit_library" | awk '$1 == "NEEDED" { print $2 }' | sort -u)
    printf '%s\n' "$list"
}

# --- what both contain -----------------------------------------------------------------------------------------------

# Help is wrapped to the terminal of any of the three streams: none of them may be one.
help_of() { COLUMNS=76 "$work/bin/bramah" "$@" --help </dev/null 2>/dev/null | cat; }

commands() { help_of | sed -n '/^Commands:/,/^$/s/^  \([a-z]\{1,\}\) .*/\1/p' | grep -vx help; }

# Text as roff that prints it as it is.
roff() { sed 's/\\/\\e/g; s/-/\\-/g; s/^\([.'\'']\)/\\\&\1/'; }

man_page() {
    local command
    printf '.TH BRAMAH 1 "%s" "bramah %s" "User Commands"\n' "$(date -d "@$SOURCE_DATE_EPOCH" +%Y-%m-%d)" "$version"
    printf '.SH NAME\nbramah \\- simulate electro\\-hydraulic machines and diagnose them from recordings\n'
    printf '.SH SYNOPSIS\n.B bramah\n[\\fIOPTIONS\\fR] \\fICOMMAND\\fR\n'
    printf '.SH DESCRIPTION\n.nf\n'
    help_of | roff
    printf '.fi\n'
    for command in $(commands); do
        printf '.SH BRAMAH %s\n.nf\n' "${command^^}"
        help_of "$command" | roff
        printf '.fi\n'
    done
}

# The circuit that the first page of the handbook explains.
first_circuit() { awk '/^```modelica/ { inside = 1; next } /^```/ { exit } inside' docs/first_circuit.md; }

# A binary is asked under the name that it will have.
make_parts() {
    local shell
    mkdir -p "$work/bin" "$work/completions"
    install -m 755 "$binary" "$work/bin/bramah"
    strip --strip-unneeded -o "$work/bin/libbramah_fmu.so" "$unit_library"
    for shell in bash zsh fish; do
        "$work/bin/bramah" completions "$shell" >"$work/completions/$shell" </dev/null
    done
    man_page >"$work/bramah.1"
    packaging/third_party.sh >"$work/THIRD-PARTY.txt"
}

# documents FOLDER: what a user reads and tries.
documents() {
    mkdir -p "$1/docs/pictures" "$1/examples/first_circuit"
    install -m 644 README.md "$1/"
    install -m 644 docs/*.md "$1/docs/"
    install -m 644 docs/pictures/*.png "$1/docs/pictures/"
    mkdir -p "$1/editors"
    cp -r editors/neovim editors/helix "$1/editors/"
    cp -r examples/diagnosis "$1/examples/"
    rm -rf "$1/examples/diagnosis/__pycache__"
    first_circuit >"$1/examples/first_circuit/Press.mo"
    grep -q '^end Press;' "$1/examples/first_circuit/Press.mo" || fail 'docs/first_circuit.md does not begin with a circuit Press'
}

# same_times FOLDER: also modes, which otherwise are those of the checkout.
same_times() {
    find "$1" -type d -exec chmod 755 {} +
    find "$1" -type f -perm -u+x -exec chmod 755 {} +
    find "$1" -type f ! -perm -u+x -exec chmod 644 {} +
    find "$1" -exec touch -h -d "@$SOURCE_DATE_EPOCH" {} +
}

# checksum FILE: as `sha256sum -c` reads it, beside the file.
checksum() { (cd "$out" && sha256sum "$1" >"$1.sha256"); }

# --- the archive -----------------------------------------------------------------------------------------------------

archive() {
    local name=bramah-$version-x86_64-linux root
    root=$work/$name
    mkdir -p "$root/completions"
    install -m 755 "$work/bin/bramah" packaging/install.sh "$root/"
    install -m 644 "$work/bin/libbramah_fmu.so" "$root/"
    install -m 644 LICENSE-MIT LICENSE-APACHE "$work/THIRD-PARTY.txt" "$work/bramah.1" "$root/"
    install -m 644 "$work/completions/bash" "$root/completions/bramah.bash"
    install -m 644 "$work/completions/zsh" "$root/completions/_bramah"
    install -m 644 "$work/completions/fish" "$root/completions/bramah.fish"
    printf 'version %s\nmachine x86_64\nglibc %s\n' "$version" "$(newest GLIBC_)" >"$root/NEEDS"
    documents "$root"
    same_times "$root"
    tar --format=ustar --sort=name --owner=0 --group=0 --numeric-owner -C "$work" -cf - "$name" | gzip -n -9 >"$out/$name.tar.gz"
    checksum "$name.tar.gz"
    say "wrote $out/$name.tar.gz (glibc $(newest GLIBC_) or newer)"
}

# --- the Debian package ----------------------------------------------------------------------------------------------

copyright() {
    cat <<TEXT
Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: bramah
Comment: The program contains SUNDIALS (BSD-3-Clause) and crates of Rust, each under its own licence.
 /usr/share/doc/bramah/THIRD-PARTY.txt.gz lists them, with the texts.

Files: *
Copyright: $(sed -n 's/^Copyright (c) //p' LICENSE-MIT)
License: Expat or Apache-2.0

License: Expat
$(sed '1,/^Copyright/d' LICENSE-MIT | sed '1{/^$/d}; s/^$/./; s/^/ /')

License: Apache-2.0
 On Debian systems, /usr/share/common-licenses/Apache-2.0 is the text.
TEXT
}

changelog() {
    printf 'bramah (%s) unstable; urgency=medium\n\n  * CHANGELOG.md.gz says what is new.\n\n -- %s  %s\n' \
        "$deb_version" "$maintainer" "$(date -R -d "@$SOURCE_DATE_EPOCH")"
}

control() {
    cat <<TEXT
Package: bramah
Version: $deb_version
Architecture: amd64
Maintainer: $maintainer
Installed-Size: $(du -sk --apparent-size "$1/usr" | cut -f1)
Depends: $(depends)
Section: science
Priority: optional
Description: simulator for electro-hydraulic machines
 Bramah simulates circuits that are written in a strict subset of Modelica, with
 a library of hydraulic, mechanical and electrical components that is built in.
 Given recordings of a test rig, it finds which effect a model lacks, and where.
TEXT
}

package() {
    local name=bramah_${deb_version}_amd64.deb root=$work/deb doc
    doc=$root/usr/share/doc/bramah
    mkdir -p "$root/DEBIAN" "$root/usr/bin" "$root"/usr/share/{bash-completion/completions,zsh/vendor-completions} \
        "$root"/usr/share/{fish/vendor_completions.d,man/man1} "$doc"
    install -m 755 "$work/bin/bramah" "$root/usr/bin/"
    mkdir -p "$root/usr/lib/bramah"
    install -m 644 "$work/bin/libbramah_fmu.so" "$root/usr/lib/bramah/"
    install -m 644 "$work/completions/bash" "$root/usr/share/bash-completion/completions/bramah"
    install -m 644 "$work/completions/zsh" "$root/usr/share/zsh/vendor-completions/_bramah"
    install -m 644 "$work/completions/fish" "$root/usr/share/fish/vendor_completions.d/bramah.fish"
    gzip -n -9 <"$work/bramah.1" >"$root/usr/share/man/man1/bramah.1.gz"
    documents "$doc"
    copyright >"$doc/copyright"
    changelog | gzip -n -9 >"$doc/changelog.gz"
    gzip -n -9 <CHANGELOG.md >"$doc/CHANGELOG.md.gz"
    gzip -n -9 <"$work/THIRD-PARTY.txt" >"$doc/THIRD-PARTY.txt.gz"
    control "$root" >"$root/DEBIAN/control"
    (cd "$root" && find usr -type f -print0 | sort -z | xargs -0 md5sum) >"$root/DEBIAN/md5sums"
    same_times "$root"
    # As many threads as cores would make the bytes depend on the machine.
    DPKG_DEB_THREADS_MAX=1 dpkg-deb --root-owner-group -Zxz --build "$root" "$out/$name" >/dev/null
    checksum "$name"
    say "wrote $out/$name (Depends: $(depends))"
}

need_tools
need_date
check_binary
check_library
depends >/dev/null
make_parts
archive
package
