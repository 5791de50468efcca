#!/bin/sh
# try_wheel.sh PYTHON BIN: the wheel and the source archive built, the wheel installed into an environment of its own with
# the locked packages, and its first steps taken in an empty folder, each with its time.
set -eu
python=$1 bin=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
timed() {
    name=$1
    shift
    began=$(date +%s)
    "$@"
    echo "$name: $(($(date +%s) - began)) s" >&2
}

"$bin/python" -m hatchling build -d "$folder/dist" >/dev/null 2>&1
ls -l "$folder/dist" >&2
"$python" -m venv "$folder/venv"
pip="$folder/venv/bin/python -m pip --disable-pip-version-check --no-input"
sed 's/ *--hash=[^ ]*//; s/ *\\$//' requirements.lock | grep -v '^ *#' | grep . >"$folder/versions.txt"
timed "install" $pip install --quiet --only-binary :all: -c "$folder/versions.txt" "$folder"/dist/*.whl
mkdir "$folder/empty"
cd "$folder/empty"
unset NUMBA_CACHE_DIR PYTHONPATH
timed "hfa demo" "$folder/venv/bin/hfa" demo
timed "hfa run HF5 --quick, the first run" "$folder/venv/bin/hfa" run HF5 --quick
timed "hfa run HF5" "$folder/venv/bin/hfa" run HF5
test -f processed/HF5/report.html
"$folder/venv/bin/hfa" docs >/dev/null
