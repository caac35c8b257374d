# shellcheck shell=bash
# What the steps of ./check are made of. To be sourced: ./check sets $target, where cargo builds, $logs, and in every step
# $scratch, a folder that is gone afterwards.
# shellcheck disable=SC2154

# The program as users build it; when it is up to date, nothing happens.
build() {
    cargo build --locked --release
}

cohelm() {
    "$target/release/cohelm" "$@"
}

# finds_nothing COMMAND...: a search, such as grep, that must find nothing.
finds_nothing() {
    local status=0
    "$@" || status=$?
    ((status == 1)) || { echo "that should not be there, or could not be looked for: $*" >&2; return 1; }
}

# all_verify DATABASE: every episode in it, and there are some, is flown again to the same bits.
all_verify() {
    cohelm verify episodes --database "$1" --json | tee "$scratch/verified"
    jq --exit-status '.finished > 0 and .identical == .finished and .in_the_air == 0 and .refused == 0' "$scratch/verified"
}

# reported_elsewhere_alike ARCHIVE DATABASE: the archive of a study and its database give the same report, to the byte, each
# in a folder of its own.
reported_elsewhere_alike() {
    local from
    rm -rf "$scratch/from-1" "$scratch/from-2"
    for from in 1 2; do
        (mkdir "$scratch/from-$from" && cd "$scratch/from-$from" && cohelm study report "${!from}" --out report >said)
    done
    [[ -s $scratch/from-1/report/report.html ]]
    diff --recursive "$scratch/from-1/report" "$scratch/from-2/report"
}

# measured NAME COMMAND...: runs a command that prints JSON, and keeps as docs/measured/NAME.json what it printed, with
# date, machine and the seconds it took.
measured() {
    need_program jq jq
    # (LC_ALL: a decimal point is a point.)
    local name=$1 LC_ALL=C TIMEFORMAT='{"wall": %R, "user": %U, "system": %S}'
    shift
    [[ $1 != cohelm ]] || build
    { time "$@" >"$scratch/printed" 2>&3; } 3>&2 2>"$scratch/seconds"
    mkdir -p "$(dirname "docs/measured/$name")"
    jq --null-input --arg command "$*" --arg date "$(date -u +%F)" --arg rust "$(rustc --version)" \
        --argjson cores "$(getconf _NPROCESSORS_ONLN)" --arg processor "$(processor)" \
        --slurpfile seconds "$scratch/seconds" --slurpfile result "$scratch/printed" \
        '{$command, $date, machine: {$processor, $cores, $rust}, seconds: $seconds[0], result: $result[0]}' \
        | sed "s|$scratch/||g; s|$PWD/||g" >"docs/measured/$name.json"
    echo "docs/measured/$name.json: $(jq --compact-output .seconds "docs/measured/$name.json")"
}

processor() {
    sed -n 's/^model name[^:]*: //p' /proc/cpuinfo 2>/dev/null | head -n 1 || sysctl -n machdep.cpu.brand_string
}

# holds NAME BOUND: what was measured under that name is within a bound, an expression of jq.
holds() {
    jq --exit-status "$2" "docs/measured/$1.json" >/dev/null || {
        echo "not so in docs/measured/$1.json: $2" >&2
        return 1
    }
    echo "docs/measured/$1.json: $2"
}

# keep NAME FILE...: files that a measured command wrote into the folder of that name, for docs/measured/NAME.
keep() {
    local name=$1
    shift
    rm -rf "docs/measured/$name"
    mkdir -p "docs/measured/$name"
    (cd "$scratch/$name" && cp -R "$@" "$OLDPWD/docs/measured/$name/")
}

# --- what the steps need -----------------------------------------------------------------------------------------

# need_program PROGRAM DEBIAN_PACKAGE...: installs the packages when the program is missing and this runs as root.
need_program() {
    command -v "$1" >/dev/null || install_packages "$@"
}

install_packages() {
    local program=$1
    shift
    if ! command -v apt-get >/dev/null; then
        echo "$program is missing: install it and run this again" >&2
        return 1
    fi
    if [[ $(id -u) != 0 ]]; then
        echo "$program is missing. Run this once, then this again:  sudo apt-get install $*" >&2
        return 1
    fi
    apt-get --quiet=2 -o DPkg::Lock::Timeout=180 update
    DEBIAN_FRONTEND=noninteractive apt-get --quiet=2 --yes --no-install-recommends -o DPkg::Lock::Timeout=180 install "$@"
}

# What builds and tests the page, exactly as web/package-lock.json names it.
need_page_tools() {
    need_program node nodejs
    need_program npm npm
    node --eval 'const [a, b] = process.versions.node.split("."); process.exit(a > 20 || (a == 20 && b >= 19) ? 0 : 1)' || {
        echo "Node $(node --version) is too old for what builds the page: install 20.19 or newer" >&2
        return 1
    }
    cmp --silent web/package-lock.json web/node_modules/.package-lock.cohelm && return
    (cd web && npm ci --no-audit --no-fund)
    cp web/package-lock.json web/node_modules/.package-lock.cohelm
}

# Chromium as $chromium, and what drives it.
need_browser() {
    need_page_tools
    chromium=$(command -v chromium || command -v chromium-browser || command -v google-chrome || true)
    [[ -n $chromium ]] && return
    install_packages chromium chromium fonts-dejavu-core
    chromium=$(command -v chromium)
}

# A Python of our own, .venv, with the Gymnasium that ours is held against.
need_gymnasium() {
    need_program jq jq
    cmp --silent tools/gymnasium.txt .venv/gymnasium.txt && return
    need_program python3 python3 python3-venv
    python3 -c 'import ensurepip' || install_packages "the module venv of Python" python3-venv
    rm -rf .venv
    python3 -m venv .venv
    .venv/bin/pip install --quiet --disable-pip-version-check --only-binary :all: --requirement tools/gymnasium.txt
    cp tools/gymnasium.txt .venv/gymnasium.txt
}

# need_package test|long: a Python of our own as $venv, with what python/requirements/$1.txt names and the wheel of these sources.
need_package() {
    need_program python3 python3 python3-venv
    venv=$PWD/.tools/python-$1
    if ! cat python/requirements/*.txt | cmp --silent - "$venv/requirements.txt"; then
        python3 -c 'import ensurepip' || install_packages "the module venv of Python" python3-venv
        rm -rf "$venv"
        python3 -m venv "$venv"
        "$venv/bin/pip" install --quiet --disable-pip-version-check --only-binary :all: --requirement "python/requirements/$1.txt"
        cat python/requirements/*.txt >"$venv/requirements.txt"
    fi
    CARGO_TARGET_DIR=$target/python "$venv/bin/maturin" build --quiet --locked --release \
        --manifest-path python/Cargo.toml --out "$scratch/wheels"
    "$venv/bin/pip" install --quiet --disable-pip-version-check --force-reinstall --no-deps "$scratch"/wheels/*.whl
}
