#!/bin/sh
# setup.sh PYTHON VENV LOCK [INSTALL...]: an environment from a lock file, wheels only, every hash checked; what INSTALL
# names to pip is installed into it without looking anywhere.
set -eu
python=$1 venv=$2 lock=$3
shift 3

"$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))' || {
    echo "make: Python 3.11 or later is needed, \"$python\" is not: choose one with PYTHON=/path/to/python3" >&2
    exit 1
}

log=$(mktemp)
trap 'rm -f "$log"' EXIT
quietly() {
    "$@" >"$log" 2>&1 && return
    cat "$log" >&2
    echo "make: setting up $venv failed at: $*" >&2
    exit 1
}

echo "Setting up $venv (once; takes a minute or two) ..." >&2
"$venv/bin/python" -m pip --version >/dev/null 2>&1 || quietly "$python" -m venv --clear "$venv"
pip="$venv/bin/python -m pip --disable-pip-version-check --no-input"
quietly $pip install --require-hashes --only-binary :all: -r "$lock"
[ $# -eq 0 ] || quietly $pip install --no-index --no-deps --no-build-isolation "$@"
