#!/bin/sh
# Searches the gains of the two vehicles and of the paper's anew, and writes them into their files.
#   [SEED=n] sh vehicles/retune.sh [hummingbird] [study] [paper]        from the repository's root; default: all, SEED=1
# The same sources and seed give the same gains: the starting gains are fixed here. Minutes to half an hour each.
set -eu

sim=${HOST_SIM:-"cargo run --release --quiet -p host-sim --"}
work=$(mktemp -d)
trap 'rm -r "$work"' EXIT

# with_gains NAME=VALUE...: the scenario on standard input with other gains and without thrust floor.
with_gains() {
    edits='/^thrust_floor = /d; /^# By .tune /d'
    for gain; do
        edits="$edits; s/^${gain%=*} = [^ ]*/${gain%=*} = ${gain#*=}/"
    done
    sed "$edits"
}

# search OUT START OPTIONS...: tunes START into OUT, whose second line then says how, and prints the report.
search() {
    out=$1 start=$2
    shift 2
    $sim tune "$start" --out "$work/$(basename "$out")" "$@" | sed "s|$work/||"
    sed "1a # By \`tune $*\` from the gains in vehicles/retune.sh." "$work/$(basename "$out")" > "$work/said"
    mv "$work/said" "$out"
}

# sibling NAME: the same vehicle and gains on the paper's trajectory, from the paper's start.
sibling() {
    {
        echo "# vehicles/$1.toml on the paper's trajectory, from the paper's start upside down. Written by vehicles/retune.sh."
        sed "/^#/d; s/^name = .*/name = \"$1-paper\"/; s/^duration = 40.0 /duration = 60.0 /; /^\[initial\]/,\$d" "vehicles/$1.toml"
        sed -n '/^\[initial\]/,$p' scenarios/paper.toml
        echo
        sed -n '/^\[reference_bounds\]/,$p' "vehicles/$1.toml"
    } > "$work/sibling"
    mv "$work/sibling" "vehicles/$1-paper.toml"
}

vehicle() {
    name=$1
    shift
    with_gains "$@" < "vehicles/$name.toml" > "$work/start.toml"
    search "vehicles/$name.toml" "$work/start.toml" \
        --seed "${SEED:-1}" --generations 150 --recovery 60 --position-error 0.01 --mrp-error 0.001
    sibling "$name"
}

[ $# -gt 0 ] || set -- hummingbird study paper
for name; do
    case $name in
        hummingbird)
            vehicle hummingbird k_p=0.4 k_v=1.6 k_f=0.5 k_s=0.9 k_theta=3.5 k_omega=0.01 \
                m_p=2.2 m_theta=0.045 m_omega=0.013 ;;
        study)
            vehicle study k_p=0.6 k_v=1.2 k_f=0.8 k_s=0.8 k_theta=2.4 k_omega=0.013 \
                m_p=1.8 m_theta=0.054 m_omega=0.015 ;;
        paper)
            with_gains k_p=100 k_v=30 k_f=4.5 k_s=1.6 k_theta=57 k_omega=0.034 m_p=3.4 m_theta=0.43 m_omega=0.12 \
                < scenarios/paper.toml | sed 's/^# The paper.s Section VI: /# The paper'"'"'s vehicle and flight with gains of our own: /
                    s/^\[gains\].*/[gains]/' > "$work/start.toml"
            search scenarios/paper-tuned.toml "$work/start.toml" --seed "${SEED:-1}" --generations 150 ;;
        *) echo "unknown: $name" >&2; exit 2 ;;
    esac
done
