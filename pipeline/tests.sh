#!/bin/sh
# tests.sh plain | odd | each COMMAND...: the tests in raw_tests/ whose names, and those of their files, can stand in a
# rule of make; a line for each of the others; or the command with each of those as its last word, after which 1 says
# that it failed for one. Names are handed on, never read as code.
set -u
LC_ALL=C
export LC_ALL
what=$1
shift
status=0

is_odd() {
    case $1 in -* | *[!A-Za-z0-9._+@-]*) return 0 ;; esac
    [ -n "$(find "raw_tests/$1" -mindepth 1 -maxdepth 1 -name '*[!A-Za-z0-9._+@-]*' -print)" ]
}

for definition in raw_tests/*/test.toml; do
    [ -f "$definition" ] || continue
    name=${definition#raw_tests/}
    name=${name%/test.toml}
    if is_odd "$name"; then
        case $what in
        odd) echo odd ;;
        each) "$@" "$name" || status=1 ;;
        esac
    elif [ "$what" = plain ]; then
        echo "$name"
    fi
done
exit $status
