#!/bin/sh
# setup.sh PYTHON VENV: the project's environment, from the lock file, wheels only, every hash checked.
set -eu
python=$1 venv=$2

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
"$venv/bin/python" -c '' 2>/dev/null || quietly "$python" -m venv --clear "$venv"
pip="$venv/bin/python -m pip --disable-pip-version-check --no-input"
quietly $pip install --require-hashes --only-binary :all: -r requirements.lock
quietly $pip install --no-index --no-deps --no-build-isolation --editable .
