#!/bin/sh
# Searches the constants of the two vehicles and of the paper's further, and writes them into their files.
#   [SEED=n] sh vehicles/retune.sh [hummingbird] [study] [paper]        from the repository's root; default: all, SEED=1
# A search starts from what a file holds. The same sources, files and seed give the same constants.
set -eu

sim=${HOST_SIM:-"cargo run --release --quiet -p host-sim --"}
work=$(mktemp -d)
trap 'rm -r "$work"' EXIT

# search FILE OPTIONS...: tunes FILE in place, its name kept, and prints the report.
search() {
    file=$1 name=$(sed -n 's/^name = "\(.*\)"/\1/p' "$1")
    shift
    $sim tune "$file" --seed "${SEED:-1}" --out "$work/$name.toml" "$@" | sed "s|$work/||"
    mv "$work/$name.toml" "$file"
}

# sibling NAME: the same vehicle and law on the paper's trajectory, from the paper's start.
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

[ $# -gt 0 ] || set -- hummingbird study paper
for name; do
    case $name in
        hummingbird | study) search "vehicles/$name.toml" ;;
        paper) search scenarios/paper-tuned.toml --generations 150 --population 48 --margin 0.05 \
            --position-error 0.001 --mrp-error 0.0001 ;;
        *) echo "unknown: $name" >&2; exit 2 ;;
    esac
    [ "$name" = paper ] || sibling "$name"
done
